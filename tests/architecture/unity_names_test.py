"""Files of a module, or of modules that are listed together in cmake/GroupByRooms.cmake, can be compiled as one
(RETARGET_UNITY_BUILD, the preset demo): the names that two of them define in their anonymous namespaces differ
in name or in parameters, from those of headers that the unit includes, and aliases of the same name mean
the same. In tests also those of functions with other parameters: a call with an initialiser list could silently reach the function of another file."""

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
ANONYMOUS = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.M | re.S)
TYPE = re.compile(r"^(?:template <[^\n]*>\n)?(?:struct|class|enum class|enum) (\w+)", re.M)
VALUE = re.compile(r"^(?:inline |static |const |constexpr |thread_local )+[\w:<>,\s*&]*?"
                   r"\b(\w+(?=\s*[={\[;])|k[A-Z]\w*(?=\())", re.M)
# The second and later names of a declaration: `constexpr double kNear = 0.1, kFar = 2.0;`.
MORE_VALUES = re.compile(r"^constexpr \w[^;(){}]*;", re.M)
FUNCTION = re.compile(r"^(?=\w)(?!using|struct|class|enum|namespace|//|#|constexpr \w+ k[A-Z])"
                      r"[\w:<>,&*\[\] ]+?[ &*\n]([\w:]+)\(([^;{}]*?)\)\s*(?:const )?(?:noexcept )?\{", re.M)
HEADER_VALUE = re.compile(r"^(?:inline )?constexpr [\w:<>,\s*&]*?\b(k[A-Z]\w*)(?=\s*[={\[;])", re.M)
ALIAS = re.compile(r"^using (\w+) =\s+(.*?);", re.M | re.S)


def groupings():
    """The modules that each kind of build compiles together, by unit."""
    text = (ROOT / "cmake/GroupByRooms.cmake").read_text()
    lists = re.findall(r"set\(retarget_unity_wings (.*?)\)", text, re.S)
    return [[(quoted or plain).split() for quoted, plain in re.findall(r'"(.*?)"|(\w+)', names)]
            for names in lists]


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
        for declaration in MORE_VALUES.findall(block):
            yield from re.findall(r",\s+(\w+) =", declaration)
        for name, parameters in FUNCTION.findall(block):
            kinds = [re.sub(r"\s*=.*|\s*\b\w+$", "", p.strip()) for p in parameters.split(",")]
            yield f"{name}({', '.join(kinds)})"


def headers_of(sources):
    """The project's headers that the sources include, directly or not."""
    found, left = set(), list(sources)
    while left:
        for name in re.findall(r'^#include "([^"]+)"', left.pop().read_text(), re.M):
            for header in (ROOT / "src" / name, ROOT / "include" / name):
                if header not in found and header.exists():
                    found.add(header)
                    left.append(header)
    return found


def hidden_names(together):
    """Names of types and values in anonymous namespaces that a header of the same unit defines as well."""
    for wings in together:
        sources = [source for wing in wings for source in sorted(ROOT.glob(f"src/{wing}/**/*.cpp"))
                   if not source.stem.endswith("_win32")]
        public = {}
        for header in headers_of(sources):
            text = header.read_text()
            for name in TYPE.findall(text) + HEADER_VALUE.findall(text):
                public[name] = header.name
        for source in sources:
            for name in definitions(source.read_text()):
                if name in public:
                    yield f"src/{'+'.join(wings)}: {name} in {source.name} and in {public[name]}"


def faults_of(together):
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
        return ["hardly any definitions were found: this test looks at the wrong place"]
    faults = [f"{unit}: {name} in {' and in '.join(sorted(files))}"
              for unit, names in sorted(units.items()) for name, files in sorted(names.items())
              if len(files) > 1]
    faults += [f"{unit}: {name} is " + " and ".join(f"{meaning} in {', '.join(sorted(files))}"
                                                    for meaning, files in sorted(meanings.items()))
               for (unit, name), meanings in sorted(aliases.items()) if len(meanings) > 1]
    return faults + list(hidden_names(together))


def main():
    kinds = groupings()
    faults = sorted({fault for together in kinds for fault in faults_of(together)})
    if len(kinds) < 2:
        faults.append("cmake/GroupByRooms.cmake: expected the units of a normal and of a quick build")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
