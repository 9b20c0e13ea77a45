"""Results of clips from the manifests of batches and of large data sets."""

from __future__ import annotations

import binascii
import math
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from retarget._errors import InputError
from retarget._results import manifest_lines
from retarget.data_set.manifest import manifest_parts, manifest_rows

#: Figures that a result keeps (docs/quality.md).
FIGURES = ("peak_speed", "contact_pct")
_COLUMNS = ["name", "status", "robot", "frames", "fps", "seconds", "message", "figures",
            "gates_missed", "worst", "worst_ratio", "signature"]


@dataclass(slots=True)
class Result:
    """The result of one clip."""

    name: str
    status: str
    """done, failed, duplicate, or lost, which the next run retries."""
    duration: float
    """Seconds of motion."""
    seconds: float
    """Seconds of solving."""
    figures: tuple[float, ...]
    """Values of FIGURES; NaN if they were not measured."""
    missed: tuple[str, ...]
    """Missed gates."""
    worst: str
    worst_ratio: float
    """Value divided by bound for the worst missed gate; infinite if the bound is 0."""
    message: str
    twin: tuple[str, float] | None
    """The clip that this one duplicates, and their distance in degrees."""
    signature: bytes
    """Coarse description of the movement (docs/batch.md); empty: unknown."""

    @property
    def passed(self) -> bool:
        return self.status == "done" and not self.missed

    @property
    def source(self) -> str:
        """The first folder of the name."""
        folder, slash, _ = self.name.partition("/")
        return folder if slash else "(no folder)"


def read_results(folder: str | os.PathLike[str]) -> list[Result]:
    """Returns the last result of every clip and robot, sorted by name.

    Args:
        folder: output folder with manifest.jsonl, or with the Parquet parts of retarget.ray.

    Raises:
        InputError: the folder has neither.
        ConfigError: the manifest is Parquet, and pyarrow is not installed.
    """
    folder = Path(folder)
    results: dict[tuple[str, str], Result] = {}
    if (folder / "manifest.jsonl").is_file():
        for line in manifest_lines(folder / "manifest.jsonl", "replace"):
            results[line.get("relative", ""), line.get("robot", "")] = _of_line(line)
    elif manifest_parts(folder):
        for row in manifest_rows(folder, _COLUMNS):
            results[row["name"], row["robot"]] = _of_row(row)
    else:
        raise InputError(f"{folder}: no manifest.jsonl and no manifest/part-*.parquet",
                         file=str(folder))
    return sorted(results.values(), key=lambda result: result.name)


def _of_line(line: Mapping[str, Any]) -> Result:
    quality = line.get("quality") or {}
    repeats = line.get("repeats")
    twin = (repeats.get("of", ""), repeats.get("distance_deg", 0.0)) if repeats else None
    return _result({**line, **quality, "name": line.get("relative", ""),
                    "message": (line.get("error") or {}).get("message")}, twin)


def _of_row(row: Mapping[str, Any]) -> Result:
    return _result({**row, "figures": dict(row["figures"] or [])}, None)


def _result(row: Mapping[str, Any], twin: tuple[str, float] | None) -> Result:
    figures = row.get("figures") or {}
    fps = row.get("fps") or 0.0
    ratio = row.get("worst_ratio")
    values = (figures.get(key) for key in FIGURES)
    return Result(
        name=row["name"], status=row.get("status", ""), seconds=row.get("seconds") or 0.0,
        duration=(row.get("frames") or 0) / fps if fps > 0 else 0.0,
        figures=tuple(math.nan if value is None else value for value in values),
        missed=tuple(map(sys.intern, row.get("gates_missed") or [])),
        worst=sys.intern(row.get("worst") or ""),
        worst_ratio=math.inf if ratio is None else ratio, message=row.get("message") or "",
        twin=twin, signature=_bytes_of(row.get("signature") or ""))


def _bytes_of(text: str) -> bytes:
    try:
        return binascii.a2b_base64(text)
    except ValueError:
        return b""
