"""Files of a wing, or of wings that stand together in cmake/GroupByRooms.cmake, can be compiled as one
(RETARGET_UNITY_BUILD, the preset demo): the names that two of them define in their anonymous namespaces differ
in name or in parameters, and aliases of the same name mean the same. In tests also those of functions with
other parameters: a call with an initialiser list could silently reach the function of another file."""

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
ANONYMOUS = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.M | re.S)
TYPE = re.compile(r"^(?:template <[^\n]*>\n)?(?:struct|class|enum class|enum) (\w+)", re.M)
VALUE = re.compile(r"^(?:inline |static |const |constexpr |thread_local )+[\w:<>,\s*&]*?\b(\w+)\s*(?:=|\{|\[|;)",
                   re.M)
# Constants with constructor arguments, and each of several in one declaration
CONSTANT = re.compile(r"^(?:inline |static )*const(?:expr)? [^;{}]*;", re.M)
CONSTANT_NAME = re.compile(r"\b(k[A-Z]\w*)(?: =(?!=)|\()")
FUNCTION = re.compile(r"^(?=\w)(?!using|struct|class|enum|namespace|//|#|constexpr \w+ k[A-Z])"
                      r"[\w:<>,&*\[\] ]+?[ &*\n]([\w:]+)\(([^;{}]*?)\)\s*(?:const )?(?:noexcept )?\{", re.M)
ALIAS = re.compile(r"^using (\w+) = (.*?);", re.M | re.S)


def wings_together():
    """The wings that the build compiles together, by unit."""
    text = (ROOT / "cmake/GroupByRooms.cmake").read_text()
    names = re.search(r"set\(retarget_unity_wings (.*?)\)", text, re.S).group(1)
    return [(quoted or plain).split() for quoted, plain in re.findall(r'"(.*?)"|(\w+)', names)]


def unit_of(folder, together):
    wing = folder.parts[1] if folder.parts[0] == "src" and len(folder.parts) > 1 else None
    for wings in together:
        if wing in wings:
            return "src/" + "+".join(wings)
    return str(folder)


def definitions(text):
    for block in ANONYMOUS.findall(text):
        yield from TYPE.findall(block)
        yield from VALUE.findall(block)
        for constant in CONSTANT.findall(block):
            yield from CONSTANT_NAME.findall(constant)
        for name, parameters in FUNCTION.findall(block):
            kinds = [re.sub(r"\s*=.*|\s*\b\w+$", "", p.strip()) for p in parameters.split(",")]
            yield f"{name}({', '.join(kinds)})"


def main():
    together = wings_together()
    units = collections.defaultdict(lambda: collections.defaultdict(set))
    aliases = collections.defaultdict(lambda: collections.defaultdict(set))
    for pattern in ("src/**/*.cpp", "tools/retarget/*.cpp", "python/src/*.cpp", "tests/*/*.cpp"):
        for source in sorted(ROOT.glob(pattern)):
            # Files for Windows are never in a unit, and not in one build with their counterparts.
            if source.name == "main.cpp" or source.stem.endswith("_win32"):
                continue
            unit = unit_of(source.parent.relative_to(ROOT), together)
            text = source.read_text()
            for name in definitions(text):
                if pattern.startswith("tests/"):
                    name = name.split("(")[0]
                units[unit][name].add(source.name)
            for block in ANONYMOUS.findall(text):
                for name, meaning in ALIAS.findall(block):
                    aliases[unit, name][" ".join(meaning.split())].add(source.name)
    if sum(map(len, units.values())) < 1000:
        print("hardly any definitions were found: this test looks at the wrong place")
        return 1
    faults = [f"{unit}: {name} in {' and in '.join(sorted(files))}"
              for unit, names in sorted(units.items()) for name, files in sorted(names.items())
              if len(files) > 1]
    faults += [f"{unit}: {name} is " + " and ".join(f"{meaning} in {', '.join(sorted(files))}"
                                                    for meaning, files in sorted(meanings.items()))
               for (unit, name), meanings in sorted(aliases.items()) if len(meanings) > 1]
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
