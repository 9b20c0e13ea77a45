"""The functions of the package. Their options come from the engine's tables (_signatures)."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from retarget import _retarget
from retarget._errors import UsageError
from retarget._results import Batch, Inspection, Report
from retarget._signatures import names_of, with_options

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from retarget import _options

StrPath = str | os.PathLike[str]
Progress = Callable[[str, int, int], object]
Bounds = float | tuple[float | None, float | None] | None


@with_options("SourceOptions")
def load(file: StrPath, *, skeleton_only: bool = False,
         **options: Unpack[_options.SourceOptions]) -> _retarget.Clip:
    """Reads a motion file, by its content: BVH, or an NPZ of SMPL or SMPL-X.

    Args:
        file: its path; "-" reads standard input.
        skeleton_only: accept a file with a skeleton but no motion.

    Raises:
        InputError: errors in the file, with line and column.
    """
    return _retarget.load(file, dict(options), skeleton_only)


@with_options("SolvingOptions", "RobotOptions", "SourceOptions")
def to_robot(clip: _retarget.Clip | StrPath, robot: _retarget.Robot | StrPath | None = None, *,
             fit: Mapping[str, Any] | None = None, threads: int = 0,
             progress: Progress | None = None, data_dir: StrPath | None = None,
             **options: Unpack[_options.ToRobotOptions]) -> _retarget.Motion:
    """A human motion as a motion of a robot: the same as the command makes, byte for byte.

    Other threads of Python run meanwhile, and may do other clips; Ctrl-C stops the work.

    Args:
        clip: a clip, or the path of one (then options of load() may be given as well).
        robot: a robot, or what Robot() takes (then its options may be given as well). A robot that
            serves many clips is better loaded once.
        fit: weights and other options of the fit by name, as a file of `fit_config` has them.
        threads: of this clip; 0: as many as are useful. The result does not depend on it.
        progress: called with (stage, done, total) up to twenty times a second in this thread,
            stage being "frames" or "fit". What it raises stops the work.
        data_dir: folder with robots/ and configs/, of a robot that is loaded here.

    Raises:
        UsageError: options that contradict each other.
        InputError: no human in the clip, a part outside of it, a bone that is missing.
        ConfigError: an unknown robot, errors in files of options.
    """
    given: dict[str, Any] = dict(options)
    source = _taken(given, names_of("SourceOptions") - names_of("SolvingOptions"))
    of_robot = _taken(given, names_of("RobotOptions"))
    if not isinstance(clip, _retarget.Clip):
        clip = load(clip, **source, memory=given.get("memory"))
    elif source:
        raise UsageError(f"{min(source)} is an option of load(), and the clip is read already")
    if not isinstance(robot, _retarget.Robot):
        robot = _retarget.Robot(robot, data_dir=data_dir, **of_robot)
    elif of_robot:
        raise UsageError(f"{min(of_robot)} is an option of Robot(), and the robot is loaded "
                         "already")
    return _retarget.to_robot(clip, robot, given, dict(fit or {}), threads, progress)


@with_options("ReadingOptions")
def load_motion(file: StrPath, robot: _retarget.Robot | StrPath, *,
                data_dir: StrPath | None = None,
                **options: Unpack[_options.ReadingOptions]) -> _retarget.Motion:
    """Reads a robot's motion: CSV, NPZ, pickle, known by its content (docs/formats.md).

    Raises:
        InputError: a malformed file; one that can be read in two ways (names the option that
            decides).
    """
    return _retarget.load_motion(file, _robot(robot, data_dir), dict(options))


@with_options("EvaluateOptions")
def evaluate(motion: _retarget.Motion, clip: _retarget.Clip | StrPath | None = None, *,
             gates: Mapping[str, Bounds] | StrPath | Literal[False] | None = None,
             **options: Unpack[_options.EvaluateOptions]) -> Report:
    """Measures a motion and holds it against gates (docs/quality.md).

    A motion of to_robot() is measured beside the clip that it was made from, rounded as it is
    written. One that was read is measured beside `clip`, at `fps` (30 without any).

    Args:
        clip: the human motion it came from; None: its own.
        gates: None: the default ones; a dictionary changes some of them (a largest value,
            (smallest, largest), or None for no gate), a file too; False: no gates at all.
    """
    if clip is not None and not isinstance(clip, _retarget.Clip):
        clip = load(clip)
    return Report(*_retarget.evaluate(motion, clip, dict(options), gates))


@with_options("HumanOptions")
def inspect(clip: _retarget.Clip | StrPath, *, data_dir: StrPath | None = None,
            **options: Unpack[_options.HumanOptions]) -> Inspection:
    """What a clip holds: joints, rate, extents, and the human that was recognised in it."""
    if not isinstance(clip, _retarget.Clip):
        clip = load(clip)
    return Inspection(*_retarget.inspect(clip, dict(options), _folder(data_dir)))


@with_options("BatchOptions")
def batch(inputs: StrPath | Iterable[StrPath], output: StrPath,
          robots: StrPath | Iterable[StrPath] | None = None, *, quality: bool = True,
          sidecar: bool = False, data_dir: StrPath | None = None,
          **options: Unpack[_options.BatchOptions]) -> Batch:
    """Retargets folders of clips, each in a process of its own (docs/batch.md).

    Args:
        inputs: files, folders and patterns.
        output: folder; manifest.jsonl and summary.csv in it tell what became of each clip.
        robots: names or folders; each of several gets a folder of its own.
        quality: measure the motions.
        sidecar: write FILE.json beside each output.

    Raises:
        UsageError: a request that contradicts itself or would write a file twice. A clip that fails
            is no error: see Batch.failed.
    """
    failed, notes = _retarget.batch(inputs, output, robots, dict(options), quality, sidecar,
                                    _folder(data_dir))
    folder = Path(os.fsdecode(output))
    manifests = sorted(folder.glob("manifest*.jsonl"))
    lines = [json.loads(line) for file in manifests
             for line in file.read_text(encoding="utf-8", errors="surrogateescape").splitlines()]
    return Batch(folder=folder, failed=failed, clips=lines, notes=list(notes))


def _taken(options: dict[str, Any], names: frozenset[str]) -> dict[str, Any]:
    """The options of these names, taken out of the others."""
    return {name: options.pop(name) for name in sorted(names & options.keys())}


def _robot(robot: _retarget.Robot | StrPath, data_dir: StrPath | None) -> _retarget.Robot:
    if isinstance(robot, _retarget.Robot):
        return robot
    return _retarget.Robot(robot, data_dir=data_dir)


def _folder(data_dir: StrPath | None) -> str:
    return "" if data_dir is None else os.fspath(data_dir)
