"""The passed motions of a data set in the format of another library."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from retarget import packs
from retarget._errors import UsageError
from retarget.data_set.manifest import FOLDER, read_manifest
from retarget.packs._clips import BatchClips, units_of_keywords
from retarget.packs._parts import new_file

_WRITERS: dict[str, Callable[..., object]] = {
    "lerobot": packs.write_lerobot, "motion_v1": packs.write_motion_v1,
    "webdataset": packs.write_webdataset}


def pack_passed(folder: Path, robot: str, kind: str, options: Mapping[str, Any],
                batch: Mapping[str, Any] | None = None) -> Path:
    """Writes the motions of passed.txt to the folder FOLDER/KIND, unless it has the same ones.

    Args:
        folder: output folder of a data set.
        kind: "lerobot", "motion_v1" or "webdataset".
        options: keyword arguments of the writer, and `ending` of packs.clips_of().
        batch: keyword arguments of the runs that wrote the motions; they state the units of CSVs.

    Returns:
        The folder of the pack.

    Raises:
        UsageError: an unknown kind, and the errors of packs.clips_of() and the writers.
    """
    if kind not in _WRITERS:
        raise UsageError(f"pack: expected one of {', '.join(_WRITERS)}, found {kind!r}")
    options = dict(options)
    clips = packs.clips_of(folder, options.pop("ending", None))
    if units := units_of_keywords(batch or {}):
        clips.csv_units = {name: units for name, file in clips.items()
                           if file.suffix.lower() == ".csv"}
    if variant := (batch or {}).get("dof"):
        clips.variants = dict.fromkeys(clips, variant)
    contents = _contents(folder, kind, options, clips)
    record = folder / FOLDER / f"{kind}.json"
    target = folder / kind
    if target.is_dir() and record.is_file() and record.read_text(encoding="utf-8") == contents:
        return target
    record.unlink(missing_ok=True)
    if kind != "webdataset":
        options["robot"] = robot
    _WRITERS[kind](clips, target, replace=True, **options)
    with new_file(record) as file:
        file.write_text(contents, encoding="utf-8")
    return target


def _contents(folder: Path, kind: str, options: Mapping[str, Any],
              clips: BatchClips) -> str:
    """Returns a record of everything that determines the bytes of a pack."""
    files = {str(file.relative_to(folder)) for file in clips.values()}
    digest = hashlib.sha256()
    for outputs in read_manifest(folder, ["outputs"])["outputs"].to_pylist():
        for file in outputs or []:
            if file["file"] in files:
                digest.update(f"{file['file']}\0{file['hash']}\n".encode(errors="surrogateescape"))
    contents: dict[str, Any] = {"kind": kind, "options": sorted(options.items()),
                                "files": digest.hexdigest()}
    if clips.csv_rates:
        contents["csv_rates"] = sorted(set(clips.csv_rates.values()))
    if clips.csv_units:
        contents["csv_units"] = sorted(next(iter(clips.csv_units.values())).items())
    if clips.variants:
        contents["dof"] = sorted(set(clips.variants.values()))
    return json.dumps(contents, default=str)
