"""The functions of the package. Their options come from the engine's tables (_signatures)."""

from __future__ import annotations

import json
import os
import re
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
Bounds = float | tuple[float | None, float | None] | list[float | None] | None


@with_options("SourceOptions")
def load(file: StrPath, *, skeleton_only: bool = False, data_dir: StrPath | None = None,
         **options: Unpack[_options.SourceOptions]) -> _retarget.Clip:
    """Reads a motion file, by its content: BVH, or an NPZ of SMPL or SMPL-X.

    With `from_robot` a robot's motion, as the human that moves so (docs/robot_to_robot.md).

    Args:
        file: its path; "-" reads standard input.
        skeleton_only: accept a file with a skeleton but no motion.
        data_dir: folder with robots/ and configs/, of `from_robot`.

    Raises:
        InputError: errors in the file, with line and column.
        ConfigError: an unknown robot.
    """
    return _retarget.load(file, dict(options), skeleton_only, data_dir)


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
        source["memory"] = given.get("memory")
    clip = _clip(clip, source, data_dir)
    robot = _robot(robot, data_dir, of_robot)
    return _retarget.to_robot(clip, robot, given, dict(fit or {}), threads, progress)


@with_options("ReadingOptions", "RobotOptions")
def load_motion(file: StrPath, robot: _retarget.Robot | StrPath | None = None, *,
                data_dir: StrPath | None = None,
                **options: Unpack[_options.LoadMotionOptions]) -> _retarget.Motion:
    """Reads a robot's motion: CSV, NPZ, pickle, known by its content (docs/formats.md).

    Args:
        robot: whose motion it is: a robot, or what Robot() takes (then its options may be given as
            well; `dof` is the variant that the file's columns are of).
        data_dir: folder with robots/ and configs/, of a robot that is loaded here.

    Raises:
        InputError: a malformed file; one that can be read in two ways (names the option that
            decides).
    """
    given: dict[str, Any] = dict(options)
    of_robot = _taken(given, names_of("RobotOptions") - names_of("ReadingOptions"))
    return _retarget.load_motion(file, _robot(robot, data_dir, of_robot), given)


@with_options("EvaluateOptions", "SourceOptions")
def evaluate(motion: _retarget.Motion, clip: _retarget.Clip | StrPath | None = None, *,
             gates: Mapping[str, Bounds] | StrPath | Literal[False] | None = None,
             **options: Unpack[_options.EvaluateClipOptions]) -> Report:
    """Measures a motion and holds it against gates (docs/quality.md).

    A motion of to_robot() is measured beside the clip that it was made from, rounded as it is
    written, at its own rate; only `limits` can be others then. One that was read is measured beside
    `clip`, at `fps` (30 without any), as the command does.

    Args:
        clip: the human motion it came from; None: its own. Of a path, options of load() may be
            given as well.
        gates: None: the default ones; a dictionary changes some of them (a largest value,
            (smallest, largest), or None for no gate), a file too; False: no gates at all.
    """
    given: dict[str, Any] = dict(options)
    source = _taken(given, names_of("SourceOptions") - names_of("EvaluateOptions"))
    if clip is not None or source:
        clip = _clip(clip, source)
    if isinstance(gates, Mapping):
        gates = dict(gates)
    return Report(*_retarget.evaluate(motion, clip, given, gates))


@with_options("HumanOptions", "SourceOptions")
def inspect(clip: _retarget.Clip | StrPath, *, data_dir: StrPath | None = None,
            **options: Unpack[_options.InspectOptions]) -> Inspection:
    """What a clip holds: joints, rate, extents, and the human that was recognised in it.

    Args:
        clip: a clip, or the path of one (then options of load() may be given as well).
        data_dir: folder with robots/ and configs/.
    """
    given: dict[str, Any] = dict(options)
    source = _taken(given, names_of("SourceOptions") - names_of("HumanOptions"))
    return Inspection(*_retarget.inspect(_clip(clip, source, data_dir), given, data_dir))


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
                                    data_dir)
    folder = Path(os.fsdecode(output))
    part = re.fullmatch(r"0*([0-9]+)/0*([0-9]+)", str(options.get("shard") or ""))
    manifest = f"manifest.{part[1]}-of-{part[2]}.jsonl" if part else "manifest.jsonl"
    return Batch(folder=folder, failed=failed, clips=_manifest_lines(folder / manifest),
                 notes=list(notes))


def _manifest_lines(file: Path) -> list[dict[str, Any]]:
    """The entries of a manifest; lines that a kill tore are left out."""
    if not file.is_file():
        return []
    lines = []
    # not splitlines(): it cuts at characters that JSON may hold
    for line in file.read_text(encoding="utf-8", errors="surrogateescape").split("\n"):
        try:
            entry = json.loads(line)
        except ValueError:
            continue
        if isinstance(entry, dict):
            lines.append(entry)
    return lines


def _taken(options: dict[str, Any], names: frozenset[str]) -> dict[str, Any]:
    """The options of these names, taken out of the others."""
    return {name: options.pop(name) for name in sorted(names & options.keys())}


def _clip(clip: _retarget.Clip | StrPath | None, options: dict[str, Any],
          data_dir: StrPath | None = None) -> _retarget.Clip:
    """A clip, or that of a path, read with options."""
    if clip is not None and not isinstance(clip, _retarget.Clip):
        return load(clip, data_dir=data_dir, **options)
    if options:
        raise UsageError(f"{min(options)} is an option of load(), and the clip is read already")
    assert clip is not None
    return clip


def _robot(robot: _retarget.Robot | StrPath | None, data_dir: StrPath | None,
           options: dict[str, Any]) -> _retarget.Robot:
    """A robot, or what Robot() makes of a name and options."""
    if not isinstance(robot, _retarget.Robot):
        return _retarget.Robot(robot, data_dir=data_dir, **options)
    given = [*sorted(options), *(["data_dir"] if data_dir is not None else [])]
    if given:
        raise UsageError(f"{given[0]} is an option of Robot(), and the robot is loaded already")
    return robot
