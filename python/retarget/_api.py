"""The functions of the package. Their options come from the engine's tables (_signatures)."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from retarget import _retarget
from retarget._errors import ArgumentTypeError, UsageError
from retarget._results import Batch, Inspection, Report, manifest_lines
from retarget._signatures import names_of, with_options

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from retarget import _options

StrPath = str | os.PathLike[str]
Progress = Callable[[str, int, int], object]
Bounds = float | tuple[float | None, float | None] | list[float | None] | None


@with_options("SourceOptions")
def load(file: StrPath, *, skeleton_only: bool = False, fps: float | None = None,
         data_dir: StrPath | None = None, **options: Unpack[_options.SourceOptions]) -> _retarget.Clip:
    """Reads a motion file; the content determines the format: BVH, or an NPZ of SMPL or SMPL-X.

    With `from_robot`, reads a robot motion as a human clip (docs/robot_to_robot.md).

    Args:
        file: path of the file; "-" reads standard input.
        skeleton_only: accept a file with a skeleton but no motion.
        fps: frames per second of the file, in place of its own; `source_fps` is an alias.
        data_dir: folder with robots/ and configs/, for `from_robot`.

    Raises:
        InputError: errors in the file, with line and column; FileNotFoundError as well if there is
            no such file.
        ConfigError: an unknown robot.
    """
    given: dict[str, Any] = dict(options)
    _take_rate(given, fps)
    return _retarget.load(file, given, skeleton_only, data_dir)


@with_options("SolvingOptions", "RobotOptions", "SourceOptions")
def to_robot(clip: _retarget.Clip | StrPath, robot: _retarget.Robot | StrPath | None = None, *,
             fit: Mapping[str, Any] | None = None, threads: int = 0,
             progress: Progress | None = None, data_dir: StrPath | None = None,
             **options: Unpack[_options.ToRobotOptions]) -> _retarget.Motion:
    """Retargets a human motion to a robot; the result has the same bytes as the command's output.

    Other Python threads can run and retarget clips at the same time. Ctrl-C stops the call.

    Args:
        clip: a clip, or the path of a file (options of load() are then allowed).
        robot: a robot, or an argument of Robot() (its options are then allowed). Load a robot
            once if it is used for many clips.
        fit: weights and other options of the fit by name, as in a `fit_config` file.
        threads: number of threads for this clip; 0: automatic. The result does not depend on it.
        progress: called with (stage, done, total) up to twenty times a second in this thread,
            where stage is "frames" or "fit". An exception from it stops the work.
        data_dir: folder with robots/ and configs/, of a robot that is loaded here.

    Raises:
        UsageError: options that contradict each other.
        InputError: no human in the clip, a part outside the clip, a missing bone.
        ConfigError: an unknown robot, errors in option files.
    """
    return _retarget.to_robot(*_planned(clip, robot, fit, data_dir, dict(options)), threads,
                              progress)


@with_options("SolvingOptions", "RobotOptions", "SourceOptions")
def make_plan(clip: _retarget.Clip | StrPath, robot: _retarget.Robot | StrPath | None = None, *,
              fit: Mapping[str, Any] | None = None, data_dir: StrPath | None = None,
              **options: Unpack[_options.ToRobotOptions]) -> _retarget.Plan:
    """Makes all decisions of to_robot() without solving: `solve(make_plan(...))` is to_robot(...).

    A plan can be read (`summary`, `frame_count`), pickled, and solved in another process.

    Args:
        clip, robot, fit, data_dir: as for to_robot().

    Raises:
        UsageError, InputError, ConfigError: as to_robot().
    """
    return _retarget.make_plan(*_planned(clip, robot, fit, data_dir, dict(options)))


def solve(plan: _retarget.Plan, *, threads: int = 0,
          progress: Progress | None = None) -> _retarget.Motion:
    """Solves a plan.

    Args:
        threads, progress: as for to_robot().

    Raises:
        InputError: a clip that cannot be resampled, or that lacks a mapped bone.
        ConfigError: weights that give numbers that are not finite.
    """
    if not isinstance(plan, _retarget.Plan):
        raise ArgumentTypeError(f"plan: expected a Plan, found {type(plan).__name__}")
    return _retarget.solve(plan, threads, progress)


@with_options("ReadingOptions", "RobotOptions")
def load_motion(file: StrPath, robot: _retarget.Robot | StrPath | None = None, *,
                fps: float | None = None, data_dir: StrPath | None = None,
                **options: Unpack[_options.LoadMotionOptions]) -> _retarget.Motion:
    """Reads a robot motion (CSV, NPZ, pickle); the content determines the format (docs/formats.md).

    Args:
        robot: the robot of the motion, or an argument of Robot() (its options are then allowed;
            `dof` is the variant of the file's columns).
        fps: frames per second of the file, in place of its own; `source_fps` is an alias.
        data_dir: folder with robots/ and configs/, of a robot that is loaded here.

    Raises:
        InputError: a malformed or ambiguous file; the message names the option that resolves
            the ambiguity.
    """
    given: dict[str, Any] = dict(options)
    _take_rate(given, fps)
    of_robot = _taken(given, names_of("RobotOptions") - names_of("ReadingOptions"))
    return _retarget.load_motion(file, _robot(robot, data_dir, of_robot), given)


@with_options("EvaluateOptions", "SourceOptions")
def evaluate(motion: _retarget.Motion, clip: _retarget.Clip | StrPath | None = None, *,
             gates: Mapping[str, Bounds] | StrPath | Literal[False] | None = None,
             **options: Unpack[_options.EvaluateClipOptions]) -> Report:
    """Measures a motion and checks it against gates (docs/quality.md).

    A motion of to_robot() is measured against its source clip, rounded as in a file, at its own
    rate; only `limits` can be changed. A motion from a file is measured against `clip`, at `fps`
    (default: the rate of the motion), as in the command.

    Args:
        clip: the human motion of the source; None: the motion's own. With a path, options of load()
            are allowed.
        gates: None: the default gates; a dictionary (values: maximum, (minimum, maximum), or
            None for no gate) or a file changes some of them; False: no gates.
    """
    if not isinstance(motion, _retarget.Motion):
        raise ArgumentTypeError(f"motion: expected a Motion, found {type(motion).__name__}")
    given: dict[str, Any] = dict(options)
    source = _taken(given, names_of("SourceOptions") - names_of("EvaluateOptions"))
    if clip is not None:
        clip = _clip(clip, source)
    elif source:
        raise _read_already(source)
    if isinstance(gates, Mapping):
        gates = dict(gates)
    return Report(*_retarget.evaluate(motion, clip, given, gates))


@with_options("HumanOptions", "SourceOptions")
def inspect(clip: _retarget.Clip | StrPath, *, data_dir: StrPath | None = None,
            **options: Unpack[_options.InspectOptions]) -> Inspection:
    """Describes a clip: joints, rate, extents, and the recognised human.

    Args:
        clip: a clip, or the path of a file (options of load() are then allowed).
        data_dir: folder with robots/ and configs/.
    """
    given: dict[str, Any] = dict(options)
    source = _taken(given, names_of("SourceOptions") - names_of("HumanOptions"))
    return Inspection(*_retarget.inspect(_clip(clip, source, data_dir), given, data_dir))


@with_options("BatchOptions")
def batch(inputs: StrPath | Iterable[StrPath], output: StrPath,
          robots: _retarget.Robot | StrPath | Iterable[StrPath] | None = None, *,
          quality: bool = True, sidecar: bool = False, data_dir: StrPath | None = None,
          **options: Unpack[_options.BatchOptions]) -> Batch:
    """Retargets folders of clips, each clip in its own process (docs/batch.md).

    Args:
        inputs: files, folders and patterns.
        output: folder; manifest.jsonl and summary.csv in it list the results of all clips.
        robots: names or folders, or one Robot; with several, each has its own output folder.
        quality: measure the motions.
        sidecar: write FILE.json next to every output.

    Raises:
        UsageError: a request that contradicts itself or would write a file twice. A failed
            clip is not an error: see Batch.failed.
    """
    _check_loaded(robots, data_dir, options)
    failed, notes = _retarget.batch(inputs, output, robots, dict(options), quality, sidecar,
                                    data_dir)
    folder = Path(os.fsdecode(output))
    part = re.fullmatch(r"0*([0-9]+)/0*([0-9]+)", str(options.get("shard") or ""))
    manifest = f"manifest.{part[1]}-of-{part[2]}.jsonl" if part else "manifest.jsonl"
    clips = list(manifest_lines(folder / manifest, "surrogateescape"))
    return Batch(folder=folder, failed=failed, clips=clips, notes=list(notes))


def _take_rate(options: dict[str, Any], fps: float | None) -> None:
    """Sets the rate of a file from `fps`."""
    if fps is None:
        return
    if options.get("source_fps") is not None:
        raise UsageError("fps and source_fps are the same option: give one of them")
    options["source_fps"] = fps


def _taken(options: dict[str, Any], names: frozenset[str]) -> dict[str, Any]:
    """Removes the options with these names and returns them."""
    return {name: options.pop(name) for name in sorted(names & options.keys())}


def _clip(clip: _retarget.Clip | StrPath | None, options: dict[str, Any],
          data_dir: StrPath | None = None) -> _retarget.Clip:
    """Returns the clip, or reads it from a path with options."""
    if clip is None:
        raise ArgumentTypeError("clip: expected a Clip or a path, found NoneType")
    if not isinstance(clip, _retarget.Clip):
        return load(clip, data_dir=data_dir, **options)
    if options:
        raise _read_already(options)
    return clip


def _read_already(options: Mapping[str, Any]) -> UsageError:
    return UsageError(f"{min(options)} is an option of load(), but the clip is already loaded")


def _planned(clip: _retarget.Clip | StrPath | None, robot: _retarget.Robot | StrPath | None,
             fit: Mapping[str, Any] | None, data_dir: StrPath | None,
             given: dict[str, Any]) -> tuple[_retarget.Clip, _retarget.Robot, dict[str, Any],
                                             dict[str, Any]]:
    """Returns clip, robot, options and options of the fit of a plan."""
    source = _taken(given, names_of("SourceOptions") - names_of("SolvingOptions"))
    of_robot = _taken(given, names_of("RobotOptions"))
    if not isinstance(clip, _retarget.Clip):
        source["memory"] = given.get("memory")
    clip = _clip(clip, source, data_dir)
    return clip, _robot(robot, data_dir, of_robot), given, _fit_options(fit)


def _fit_options(fit: Mapping[str, Any] | None) -> dict[str, Any]:
    """Returns the options of the fit by name; None: the defaults."""
    if fit is None:
        return {}
    if not isinstance(fit, Mapping):
        raise ArgumentTypeError(f"fit: expected a mapping of options, found {type(fit).__name__}")
    return dict(fit)


def _check_loaded(robot: object, data_dir: StrPath | None, options: Mapping[str, Any]) -> None:
    """Rejects options of Robot() if the robot is already loaded."""
    of_robot = names_of("RobotOptions") & {name for name in options if options[name] is not None}
    if isinstance(robot, _retarget.Robot):
        _robot(robot, data_dir, dict.fromkeys(of_robot))


def _robot(robot: _retarget.Robot | StrPath | None, data_dir: StrPath | None,
           options: dict[str, Any]) -> _retarget.Robot:
    """Returns the robot, or loads it by name with options."""
    if not isinstance(robot, _retarget.Robot):
        return _retarget.Robot(robot, data_dir=data_dir, **options)
    given = [*sorted(options), *(["data_dir"] if data_dir is not None else [])]
    if given:
        raise UsageError(f"{given[0]} is an option of Robot(), but the robot is already loaded")
    return robot
