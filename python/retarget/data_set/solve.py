"""One task of a data set: solves a few clips in its own process."""

from __future__ import annotations

import json
import os
import pickle
import shutil
import subprocess
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from retarget._errors import InputError
from retarget.data_set.inputs import ClipSource, place
from retarget.data_set.isolated import ERROR

WORK = ".work"
CLIPS = "clips.json"
# The batch's message for a clip whose process ended.
_ENDED = "the clip's process "


@dataclass(frozen=True, slots=True)
class Request:
    """The members that all tasks of a data set share."""

    folder: str
    """Output folder, the same on every machine."""
    robot: str
    options: Mapping[str, Any]
    """Keyword arguments of retarget.batch()."""
    fingerprint: str
    """Hash of everything that determines the bytes."""
    storage_options: Mapping[str, Any]


def solve_clips(request: Request, clips: list[tuple[ClipSource, int]],
                work: str) -> list[dict[str, Any]]:
    """Solves clips and moves their files into the output folder.

    Args:
        clips: clips, and how many times each was begun before.
        work: name of a new folder in FOLDER/.work for unfinished files. It names the clips while
            they are in progress, so a later run knows about clips that ended everything.

    Returns:
        A row of the manifest per clip: done, failed, or lost if its process ended.

    Raises:
        Error: the request is wrong for all clips: an unknown option or robot.
        OSError: the output folder cannot be written.
    """
    output = Path(request.folder)
    folder = output / WORK / work
    folder.mkdir(parents=True)
    rows = {clip.name: new_row(request, clip, tries + 1) for clip, tries in clips}
    try:
        _write_names(folder, clips)
        unreadable = _place_all(request, clips, folder / "in")
        for name, message in unreadable.items():
            rows[name].update(status="failed", message=message, exit_code=3)
        if len(unreadable) < len(clips):
            if _run(request, folder):
                for name in rows.keys() - unreadable.keys():
                    rows[name].update(status="failed", message="no motion", exit_code=3)
            for line in _lines(folder / "out/manifest.jsonl"):
                row = rows[line["relative"]]
                _fill(row, line)
                for file in row["outputs"]:
                    _publish(folder / "out", output, file["file"])
        return list(rows.values())
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def new_row(request: Request, clip: ClipSource, tries: int) -> dict[str, Any]:
    """Returns the row of a clip whose process ended."""
    return {"name": clip.name, "status": "lost", "tries": tries, "location": clip.location,
            "offset": clip.offset, "input_bytes": clip.bytes, "input_version": clip.version,
            "options": request.fingerprint, "robot": request.robot, "outputs": [],
            "message": "the clip's process ended"}


def interrupted(folder: Path) -> Iterable[tuple[Path, list[str]]]:
    """Yields the work folders of killed tasks, and their clips."""
    for work in sorted((folder / WORK).glob("*/")):
        try:
            yield work, json.loads((work / CLIPS).read_text(encoding="utf-8"))["clips"]
        except (OSError, ValueError, KeyError):
            # The process ended before it began a clip.
            yield work, []


def _write_names(folder: Path, clips: list[tuple[ClipSource, int]]) -> None:
    about = {"pid": os.getpid(), "clips": [clip.name for clip, _ in clips]}
    unfinished = folder / f"{CLIPS}.new"
    unfinished.write_text(json.dumps(about), encoding="utf-8")
    unfinished.replace(folder / CLIPS)


def _place_all(request: Request, clips: list[tuple[ClipSource, int]],
               folder: Path) -> dict[str, str]:
    """Returns the errors of clips that cannot be read, by name."""
    errors = {}
    for clip, _ in clips:
        try:
            place(clip, folder, request.storage_options)
        # File systems of fsspec raise their own exceptions.
        except Exception as error:
            errors[clip.name] = f"{clip.location}: {error}"
            (folder / clip.name).unlink(missing_ok=True)
    return errors


def _run(request: Request, folder: Path) -> bool:
    """Runs a batch; returns whether it finished.

    Raises:
        Error: the request is wrong.
        RuntimeError: the installation is faulty.
    """
    arguments = {"inputs": str(folder / "in"), "output": str(folder / "out"),
                 "robots": request.robot, "jobs": 1, **request.options}
    file = folder / "request.pickle"
    file.write_bytes(pickle.dumps((os.getpid(), arguments)))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    process = subprocess.run([sys.executable, "-m", "retarget.data_set.isolated", str(file)],
                             env=environment, stdin=subprocess.DEVNULL, check=False,
                             stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    if (folder / ERROR).exists():
        error = pickle.loads((folder / ERROR).read_bytes())
        # None of the files is a motion.
        if not isinstance(error, InputError):
            raise error
    elif process.returncode > 0:
        raise RuntimeError(process.stderr.decode(errors="replace")[-4000:])
    return process.returncode >= 0


def _lines(manifest: Path) -> Iterable[dict[str, Any]]:
    """Yields the complete lines of a batch's manifest."""
    if not manifest.exists():
        return
    for line in manifest.read_text(encoding="utf-8", errors="surrogateescape").split("\n"):
        try:
            yield json.loads(line)
        except ValueError:
            continue


def _fill(row: dict[str, Any], line: dict[str, Any]) -> None:
    """Copies a line of a batch's manifest to a row."""
    error = line.get("error") or {}
    message = error.get("message", "")
    row["message"] = message
    row["exit_code"] = error.get("exit_code", 0)
    row["status"] = "lost" if message.startswith(_ENDED) else line["status"]
    row["outputs"] = [{key: file[key] for key in ("file", "bytes", "hash")}
                      for file in line["outputs"]]
    for key in ("frames", "fps", "seconds", "taken_as", "mapping", "signature"):
        row[key] = line.get(key)
    row["warnings"] = line.get("warnings") or []
    quality = line.get("quality") or {}
    row["figures"] = list((quality.get("figures") or {}).items())
    row["gates_missed"] = quality.get("gates_missed") or []
    row["worst"], row["worst_ratio"] = quality.get("worst"), quality.get("worst_ratio")


def _publish(source: Path, output: Path, file: str) -> None:
    target = output / file
    target.parent.mkdir(parents=True, exist_ok=True)
    (source / file).replace(target)
