"""No two headers define a type of the same name: both would be retarget::Name, and the linker would
take the functions of one for the other's."""

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
TYPE = re.compile(r"^(?:struct|class|enum class|enum) (\w+)(?: final)?(?: : [^;{]*)?\s*\{", re.M)


def main():
    files = collections.defaultdict(list)
    for folder in ("include", "src"):
        for header in sorted((ROOT / folder).rglob("*.h")):
            for name in TYPE.findall(header.read_text()):
                files[name].append(str(header.relative_to(ROOT)))
    if len(files) < 100:
        print("hardly any types were found: this test looks at the wrong place")
        return 1
    doubles = {name: found for name, found in files.items() if len(found) > 1}
    for name, found in doubles.items():
        print(f"{name} is defined in {' and in '.join(found)}")
    return 1 if doubles else 0


if __name__ == "__main__":
    sys.exit(main())
