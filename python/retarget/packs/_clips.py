"""Named motions: their sources and readers."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

import retarget
from retarget import _retarget
from retarget._errors import ArgumentTypeError, InputError, UsageError

StrPath = str | os.PathLike[str]
Source = _retarget.Motion | StrPath
Clips = Mapping[str, Source] | Iterable[tuple[str, Source]]


@dataclass(frozen=True)
class NamedMotion:
    """A motion to write."""

    name: str
    motion: _retarget.Motion
    file: str
    """Path of the file that the motion was read from; empty for a Motion."""


class BatchClips(dict[str, Path]):
    """Files of a batch by the name of their clip."""

    def __init__(self) -> None:
        super().__init__()
        self.csv_rates: dict[str, float] = {}
        """Frames per second of CSVs, which do not state them, by name, as the batch recorded."""
        self.csv_units: dict[str, dict[str, str]] = {}
        """Options of load_motion() for CSVs in degrees or centimetres, by name, as recorded."""
        self.variants: dict[str, str] = {}
        """Variants of the robots (`dof`) whose joints the files have, by name, as recorded."""
        self.hashes: dict[str, str] = {}
        """SHA-256 of the files, by name, as recorded."""
        self.robots: dict[str, str] = {}
        """Names of the robots, as recorded."""
        self.left_out: dict[str, str] = {}
        """Clips of other robots than the one given to clips_of(), and these robots, by name."""

    def is_unchanged(self, name: str, data: bytes) -> bool:
        """Whether the bytes of a clip's file have the recorded hash, or there is none."""
        recorded = self.hashes.get(name)
        return not recorded or recorded == f"sha256:{hashlib.sha256(data).hexdigest()}"

    def check_unchanged(self, name: str, file: StrPath, data: bytes) -> None:
        """Compares the bytes of a clip's file with the recorded hash, if there is one.

        Raises:
            InputError: the file has changed since the batch.
        """
        if not self.is_unchanged(name, data):
            file = os.fspath(file)
            raise InputError(f"{file}: has changed since the batch wrote it; run the batch again, "
                             "or give the files as a dictionary", file=file)


@dataclass(frozen=True)
class _Entry:
    """A line of the manifest of a batch."""

    hashes: dict[str, str]
    """SHA-256 of the files, by path relative to the folder of the batch."""
    robot: str
    fps: float
    options: str
    """Key of the options in options.json."""


def clips_of(folder: StrPath, ending: str | None = None,
             robot: _retarget.Robot | StrPath | None = None) -> BatchClips:
    """Returns the passed motions of a batch by name.

    Args:
        folder: output folder of `retarget batch` or retarget_dataset(), which has passed.txt.
        ending: end of the file names to take, for batches with several formats: ".mjlab.npz".
            Names lack it; without `ending`, names lack the last extension.
        robot: takes only the motions of this robot from a batch of several.

    Returns:
        Files by the name of their clip, "a/walk". The writers read CSVs at the rate and in the
        units that the batch records.

    Raises:
        InputError: the folder has no passed.txt.
        UsageError: two files are of the same clip, so `ending` is needed; no motion of the robot.
    """
    folder = Path(folder)
    listed = folder / "passed.txt"
    if not listed.is_file():
        raise InputError(f"{listed}: no such file; expected the output folder of a batch",
                         file=str(listed))
    clips = BatchClips()
    names: dict[str, str] = {}
    for line in listed.read_text(encoding="utf-8", errors="surrogateescape").split("\n"):
        if not line or (ending is not None and not line.endswith(ending)):
            continue
        name = line[:-len(ending)] if ending else str(PurePosixPath(line).with_suffix(""))
        if name in clips:
            raise _same_clip(str(clips[name].relative_to(folder)), line)
        clips[name] = folder / line
        names[line] = name
    runs = _recorded_options(folder)
    for entry in _entries(folder):
        taken = [file for file in entry.hashes if file in names]
        if len(taken) > 1:
            raise _same_clip(*taken[:2])
        for file in taken:
            name = names[file]
            clips.hashes[name] = entry.hashes[file]
            if entry.robot:
                clips.robots[name] = entry.robot
            options = runs.get(entry.options, {})
            if variant := options.get("dof"):
                clips.variants[name] = variant
            if not file.lower().endswith(".csv"):
                continue
            if entry.fps > 0:
                clips.csv_rates[name] = entry.fps
            if options:
                clips.csv_units[name] = _units_of(options)
    if robot is not None:
        _leave_out_others(clips, robot)
    return clips


def _leave_out_others(clips: BatchClips, robot: _retarget.Robot | StrPath) -> None:
    if not isinstance(robot, _retarget.Robot):
        robot = _retarget.Robot(robot)
    given = _names_of(robot)
    clips.left_out = {name: other for name, other in clips.robots.items() if other not in given}
    for name in clips.left_out:
        del clips[name]
    if clips.left_out and not clips:
        others = ", ".join(sorted(set(clips.left_out.values())))
        raise UsageError(f"robot: the batch has no motion of {robot.name}; its robots are {others}")


def _names_of(robot: _retarget.Robot) -> tuple[str, str]:
    """Returns the names under which a batch may record a robot."""
    # A robot that is given as a folder is recorded by the name in its profile.
    return robot.name, _retarget.recorded_name(robot)


def _same_clip(a: str, b: str) -> UsageError:
    dot = os.path.commonprefix([a, b]).rfind(".")
    hint = f'ending="{b[dot:]}" takes the files with this end' if dot >= 0 else "give an ending"
    return UsageError(f'"{a}" and "{b}" are of the same clip; {hint}')


def _recorded_options(folder: Path) -> dict[str, dict[str, str]]:
    """Returns the options of the runs of a batch, by key of options.json."""
    try:
        runs = json.loads((folder / "options.json").read_bytes())
        # The variant of the robot is not in "options".
        return {run["options_hash"]: {**run["options"], "dof": str(run.get("dof") or "")}
                for run in runs}
    except (AttributeError, KeyError, OSError, TypeError, ValueError):
        return {}  # Of an older version, or damaged: units are then detected.


def _units_of(options: dict[str, str]) -> dict[str, str]:
    units: dict[str, str] = {}
    if "csv-soma" in options.get("format", ""):
        return units
    if degrees := options.get("csv-degrees"):
        units["source_angles"] = "deg" if degrees == "true" else "rad"
    if centimetres := options.get("csv-centimetres"):
        units["source_unit"] = "cm" if centimetres == "true" else "m"
    # A header names the parts of the quaternion.
    if (order := options.get("csv-quat")) and options.get("csv-header") != "true":
        units["source_quat"] = order
    return units


def units_of_keywords(keywords: Mapping[str, Any]) -> dict[str, str]:
    """Returns the options of load_motion() for CSVs that a batch with these keywords writes."""
    def text(value: Any) -> str:
        if isinstance(value, bool):
            return "true" if value else "false"
        return ",".join(value) if isinstance(value, (list, tuple)) else str(value)

    names = ("format", "csv_degrees", "csv_centimetres", "csv_quat", "csv_header")
    return _units_of({name.replace("_", "-"): text(keywords[name]) for name in names
                      if keywords.get(name) is not None})


def _entries(folder: Path) -> Iterator[_Entry]:
    """Yields the lines of the manifest of a batch."""
    manifest = folder / "manifest.jsonl"
    if manifest.is_file():
        with manifest.open("rb") as lines:
            yield from filter(None, map(_entry_of_line, lines))
    elif (folder / "manifest").is_dir():
        # Of retarget_dataset(); this module cannot import it above, because it imports packs.
        from retarget.data_set.manifest import read_manifest

        table = read_manifest(folder, ["outputs", "robot", "fps"])
        for batch in table.to_batches():
            for row in batch.to_pylist():
                hashes = {each["file"]: each["hash"] or "" for each in row["outputs"] or []}
                yield _Entry(hashes, row["robot"] or "", row["fps"] or 0.0, "")


def _entry_of_line(line: bytes) -> _Entry | None:
    """Returns a line of manifest.jsonl; None for a truncated line."""
    try:
        entry = json.loads(line)
        # A name that is not UTF-8 has its bytes beside it.
        hashes = {output["file"] if output.get("file_hex") is None else
                  bytes.fromhex(output["file_hex"]).decode(errors="surrogateescape"):
                  str(output.get("hash") or "") for output in entry["outputs"]}
        return _Entry(hashes, str(entry.get("robot") or ""), float(entry.get("fps") or 0.0),
                      str(entry.get("options_hash") or ""))
    except (AttributeError, KeyError, TypeError, ValueError):
        return None


def ascending(clips: Clips) -> Iterator[tuple[str, Source]]:
    """Yields the clips in ascending order of names.

    Raises:
        UsageError: names that are not in ascending order, are repeated, or are not relative paths.
    """
    pairs = sorted(clips.items()) if isinstance(clips, Mapping) else clips
    earlier = None
    for pair in pairs:
        name, source = pair
        if not isinstance(name, str) or not is_name(name):
            raise UsageError(f'clips: expected names such as "a/walk", found {name!r}')
        if earlier is not None and name <= earlier:
            raise UsageError(f"clips: expected ascending names, found {name!r} after {earlier!r}; "
                             "a dictionary is sorted by itself")
        earlier = name
        yield name, source


def is_name(name: str) -> bool:
    """Whether a name is a relative path without empty, "." and ".." parts."""
    return "\\" not in name and all(part not in ("", ".", "..") for part in name.split("/"))


def _version(file: Path) -> tuple[int, int, int] | None:
    """Returns what changes with the contents of a file; None: no such file."""
    try:
        status = file.stat()
    except OSError:
        return None
    return status.st_ino, status.st_size, status.st_mtime_ns


def _rate_in(sidecar: Path) -> float | None:
    """Returns the rate that the sidecar of a CSV records; None: it has none."""
    try:
        return float(json.loads(sidecar.read_bytes())["found"]["fps"])
    except (KeyError, OSError, TypeError, ValueError):
        return None


class MotionReader:
    """Reads motions of one robot at one frame rate, `fps`, which is also that of CSVs.

    CSVs have the rate of their sidecar or of the manifest of their batch, which `fps` must not
    contradict.
    """

    def __init__(self, robot: _retarget.Robot | StrPath | None, fps: float | None) -> None:
        self._choice = None if isinstance(robot, _retarget.Robot) else robot
        self.robot = robot if self._choice is None else _retarget.Robot(self._choice)
        self._batch = BatchClips()
        self.fps = fps
        self._csv_fps = fps
        self.joint_names: list[str] | None = None
        self.contact_names: list[str] = []

    def motions(self, clips: Clips) -> Iterator[NamedMotion]:
        """Yields the motions one by one.

        Raises:
            UsageError: files without `robot`, or motions that differ in joints or frame rate.
            InputError: a file that is not a motion of the robot, has changed since the batch, or
                changes while it is read.
        """
        if isinstance(clips, BatchClips):
            self._batch = clips
            self._take_recorded_variant()
        for name, source in ascending(clips):
            motion = self._motion(name, source)
            self._check(name, motion)
            file = "" if isinstance(source, _retarget.Motion) else os.fspath(source)
            yield NamedMotion(name, motion, file)

    def _motion(self, name: str, source: Source) -> _retarget.Motion:
        if isinstance(source, _retarget.Motion):
            return source
        if not isinstance(source, (str, os.PathLike)):
            raise ArgumentTypeError(f"clips[{name!r}]: expected a Motion or a path, found "
                                    f"{type(source).__name__}")
        if self.robot is None:
            raise UsageError("robot: needed to read motion files")
        file = Path(source)
        is_hashed = bool(self._batch.hashes.get(name)) and file.is_file()
        before = _version(file)
        if is_hashed:
            self._batch.check_unchanged(name, source, file.read_bytes())
        recorded = self._batch.robots.get(name, self.robot.name)
        if recorded not in _names_of(self.robot):
            raise UsageError(f"clips[{name!r}]: the batch records a motion of {recorded}, but "
                             f"robot is {self.robot.name}; clips_of(..., robot=) takes only the "
                             "motions of one robot")
        options = dict(self._batch.csv_units.get(name, {}))
        if variant := self._batch.variants.get(name):
            options["source_dof"] = variant
        motion = retarget.load_motion(source, self.robot, source_fps=self._rate(name, source),
                                      **options)
        # The hash is of other bytes than the motion's if the file was replaced in between. A copy of
        # the same bytes is not a change.
        if is_hashed and _version(file) != before and not self._has_recorded_bytes(name, file):
            raise InputError(f"{file}: changed while it was read", file=os.fspath(source))
        return motion

    def _has_recorded_bytes(self, name: str, file: Path) -> bool:
        try:
            return self._batch.is_unchanged(name, file.read_bytes())
        except OSError:
            return False

    def _take_recorded_variant(self) -> None:
        """Replaces a robot given by name by its variant that all files have."""
        variants = {self._batch.variants.get(name, "") for name in self._batch}
        variant = variants.pop() if len(variants) == 1 else ""
        if variant and self._choice is not None:
            self.robot = _retarget.Robot(self._choice, dof=variant)

    def _rate(self, name: str, source: StrPath) -> float | None:
        """Returns the rate of a CSV; None: the file or its sidecar has a rate."""
        file = os.fspath(source)
        if not file.lower().endswith(".csv"):
            return None
        sidecar = Path(file + ".json")
        if self._csv_fps is None:
            return None if sidecar.is_file() else self._batch.csv_rates.get(name)
        recorded = _rate_in(sidecar) or self._batch.csv_rates.get(name, self._csv_fps)
        if not np.isclose(recorded, self._csv_fps, rtol=1e-6):
            raise UsageError(f"clips[{name!r}]: {recorded:g} frames per second recorded, but fps "
                             f"is {self._csv_fps:g}; omit fps to take the recorded rate")
        return self._csv_fps

    def _check(self, name: str, motion: _retarget.Motion) -> None:
        if self.joint_names is None:
            self.robot = self.robot or motion.robot
            self.fps = self.fps or motion.fps
            self.joint_names = motion.joint_names
            self.contact_names = motion.contact_names
        if motion.joint_names != self.joint_names:
            raise UsageError(f"clips[{name!r}]: the joints differ from those of the first clip")
        # The rate of an NPZ is rounded.
        if not np.isclose(motion.fps, self.fps, rtol=1e-6):
            raise UsageError(f"clips[{name!r}]: {motion.fps:g} frames per second, expected "
                             f"{self.fps:g}")
