"""The command `retarget`: the native program of this package."""

import os
import sys
from pathlib import Path

PROGRAM = Path(__file__).resolve().parent / "bin" / "retarget"


def main() -> None:
    """Becomes the program, with the arguments of this process."""
    os.execv(PROGRAM, [sys.argv[0], *sys.argv[1:]])
