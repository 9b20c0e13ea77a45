"""Writes the stubs of the package that was built: `make_stubs.py FOLDER`.

_retarget.pyi is nanobind's, of the module; _options.pyi has a TypedDict for each table of options,
so that editors and type checkers know every keyword.
"""

from __future__ import annotations

import re
import sys
import textwrap
from pathlib import Path

from nanobind import stubgen

from retarget import _retarget

HEAD = '''"""Options of functions, from the engine's tables. Each may be left out."""

import os
from collections.abc import Sequence
from typing import Any, Literal, TypedDict

from numpy import floating

Number = float | floating[Any]
StrPath = str | os.PathLike[str]
'''

# Functions that take the options of several tables.
JOINED = {"ToRobotOptions": ("SolvingOptions", "RobotOptions", "SourceOptions"),
          "LoadMotionOptions": ("ReadingOptions", "RobotOptions"),
          "EvaluateClipOptions": ("EvaluateOptions", "SourceOptions"),
          "InspectOptions": ("HumanOptions", "SourceOptions"),
          "PlayOptions": ("PlayerOptions", "SourceOptions"),
          "LiveRobotOptions": ("LiveOptions", "RobotOptions", "SourceOptions"),
          **{f"{edit}EditOptions": (f"{edit}Options", "EditOptions")
             for edit in ("Ground", "Loop", "Concatenate", "Path")}}


def typed_dict(name: str, rows: list[dict]) -> str:
    """A class with one annotated member for each row."""
    lines = ["", "", f"class {name}(TypedDict, total=False):"]
    for row in rows:
        kind = re.sub(r"\bfloat\b", "Number", row["type"])
        lines.append(f"    {row['name']}: {kind} | None")
        text = textwrap.fill(row["help"].replace("\\", "\\\\").replace('"', "'"), 92,
                             break_on_hyphens=False)
        lines.append(textwrap.indent(f'"""{text}"""', "    "))
    return "\n".join(lines)


def main(folder: Path) -> None:
    tables = _retarget.option_tables()
    for name, parts in JOINED.items():
        tables[name] = list({row["name"]: row for part in parts for row in tables[part]}.values())
    text = HEAD + "\n".join(typed_dict(name, rows) for name, rows in tables.items()) + "\n"
    (folder / "_options.pyi").write_text(text, encoding="utf-8")
    # In this process: an emulated Python cannot start itself.
    stubgen.main(["-q", "-m", "retarget._retarget", "-o", str(folder / "_retarget.pyi")])
    stub = (folder / "_retarget.pyi").read_text(encoding="utf-8")
    # The module with the options must be imported explicitly.
    stub = stub.replace("\nimport retarget\n", "\nimport retarget._options\n")
    (folder / "_retarget.pyi").write_text(stub, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
