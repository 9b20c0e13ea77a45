"""The command `retarget`: the native program of this package."""

import os
import sys
from pathlib import Path

PROGRAM = Path(__file__).resolve().parent / "bin" / "retarget"
# In a build tree, the package is a folder of links, and the program is a sibling of that folder.
_BUILT = Path(__file__).parents[2] / "tools" / "retarget" / "retarget"


def main() -> None:
    """Becomes the program, with the arguments of this process."""
    for program in (PROGRAM, _BUILT):
        if program.is_file():
            os.execv(program, [sys.argv[0], *sys.argv[1:]])
    sys.exit(f"retarget: the command was not built: there is no {PROGRAM}")
