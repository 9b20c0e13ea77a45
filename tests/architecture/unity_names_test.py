"""Files of a room can be compiled as one (RETARGET_UNITY_BUILD, the preset demo): the names that two of
them define in their anonymous namespaces differ in name or in parameters. In tests also those of functions
with other parameters: a call with an initialiser list could silently reach the function of another file."""

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
ANONYMOUS = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.M | re.S)
TYPE = re.compile(r"^(?:template <[^\n]*>\n)?(?:struct|class|enum class|enum) (\w+)", re.M)
VALUE = re.compile(r"^(?:inline |static |const |constexpr |thread_local )+[\w:<>,\s*&]*?\b(\w+)\s*(?:=|\{|\[|;)",
                   re.M)
FUNCTION = re.compile(r"^(?=\w)(?!using|struct|class|enum|namespace|//|#|constexpr \w+ k[A-Z])"
                      r"[\w:<>,&*\[\] ]+?[ &*\n]([\w:]+)\(([^;{}]*?)\)\s*(?:const )?(?:noexcept )?\{", re.M)


def definitions(text):
    for block in ANONYMOUS.findall(text):
        yield from TYPE.findall(block)
        yield from VALUE.findall(block)
        for name, parameters in FUNCTION.findall(block):
            kinds = [re.sub(r"\s*=.*|\s*\b\w+$", "", p.strip()) for p in parameters.split(",")]
            yield f"{name}({', '.join(kinds)})"


def main():
    rooms = collections.defaultdict(lambda: collections.defaultdict(set))
    for pattern in ("src/**/*.cpp", "tools/retarget/*.cpp", "python/src/*.cpp", "tests/*/*.cpp"):
        for source in sorted(ROOT.glob(pattern)):
            # Files for Windows are never in a unit, and not in one build with their counterparts.
            if source.name == "main.cpp" or source.stem.endswith("_win32"):
                continue
            for name in definitions(source.read_text()):
                if pattern.startswith("tests/"):
                    name = name.split("(")[0]
                rooms[str(source.parent.relative_to(ROOT))][name].add(source.name)
    if sum(map(len, rooms.values())) < 1000:
        print("hardly any definitions were found: this test looks at the wrong place")
        return 1
    faults = [f"{room}: {name} in {' and in '.join(sorted(files))}"
              for room, names in sorted(rooms.items()) for name, files in sorted(names.items())
              if len(files) > 1]
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
