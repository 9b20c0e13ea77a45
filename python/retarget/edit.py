"""The edits of `retarget edit`: clips in, clips out (docs/editing.md).

Every function returns a new clip. Options control how the human in the clip is recognised and which
part of it is used; uncertain guesses raise a warning (RetargetWarning).
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from retarget import _retarget
from retarget._errors import ArgumentTypeError, UsageError, checked_number
from retarget._signatures import with_options

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from retarget import _options
    from retarget._retarget import Clip

__all__ = [
    "concatenate", "follow_path", "ground", "lafan1", "loop", "mirror", "move",
    "resample", "rest", "transfer", "trim", "turn"]

StrPath = str | os.PathLike[str]


def _checked(clip: Clip, name: str = "clip") -> Clip:
    if not isinstance(clip, _retarget.Clip):
        raise ArgumentTypeError(f"{name}: expected a Clip, found {type(clip).__name__}")
    return clip


def trim(clip: Clip, *, start: float | None = None, end: float | None = None,
         frames: str | slice | None = None) -> Clip:
    """Returns an excerpt by times (seconds, inclusive) or by frames (`"a:b"` or a slice)."""
    if isinstance(frames, slice):
        if frames.step not in (None, 1):
            raise UsageError("frames: a slice with a step; resample() gives fewer frames")
        first, behind, _ = frames.indices(len(clip))
        frames = f"{first}:{behind}"
    return _retarget.edit_trim(_checked(clip), {"start": start, "end": end, "frames": frames})


@with_options("ResampleOptions")
def resample(clip: Clip, fps: float | None = None, *, antialias: bool = True,
             **options: Unpack[_options.ResampleOptions]) -> Clip:
    """Changes the frame rate, the speed, or both.

    Args:
        fps: frames per second; None: the clip's.
        antialias: low-pass a clip that is brought to a lower rate.
    """
    if not isinstance(antialias, bool):
        raise ArgumentTypeError(f"antialias: expected True or False, found {antialias!r}")
    if not antialias:
        if options.get("no_antialias") is False:
            raise UsageError("antialias=False and no_antialias=False contradict each other")
        options["no_antialias"] = True
    return _retarget.edit_resample(_checked(clip), {"fps": fps, **options})


def rest(clip: Clip, like: Clip) -> Clip:
    """Transfers the motion to the skeleton of `like`: the same joints, another rest pose."""
    return _retarget.edit_rest(_checked(clip), _checked(like, "like"))


@with_options("EditOptions")
def transfer(clip: Clip, like: Clip, *, data_dir: StrPath | None = None,
             **options: Unpack[_options.EditOptions]) -> Clip:
    """Transfers the motion to the skeleton of `like`, through the T-pose."""
    return _retarget.edit_transfer(_checked(clip), _checked(like, "like"), dict(options), data_dir)


@with_options("EditOptions")
def lafan1(clip: Clip, *, data_dir: StrPath | None = None,
           **options: Unpack[_options.EditOptions]) -> Clip:
    """Converts the clip to the LAFAN1 skeleton: its joints, names, axes and size."""
    return _retarget.edit_lafan1(_checked(clip), dict(options), data_dir)


@with_options("EditOptions")
def mirror(clip: Clip, *, data_dir: StrPath | None = None,
           **options: Unpack[_options.EditOptions]) -> Clip:
    """Mirrors the motion: swaps left and right."""
    return _retarget.edit_mirror(_checked(clip), dict(options), data_dir)


@with_options("GroundOptions", "EditOptions")
def ground(clip: Clip, floor: float | None = None, *, data_dir: StrPath | None = None,
           **options: Unpack[_options.GroundEditOptions]) -> Clip:
    """Raises or lowers the motion so that the floor is at height 0."""
    return _retarget.edit_ground(_checked(clip), {"floor": floor, **options}, data_dir)


@with_options("EditOptions")
def turn(clip: Clip, degrees: float, *, data_dir: StrPath | None = None,
         **options: Unpack[_options.EditOptions]) -> Clip:
    """Turns the motion about the vertical axis at its start; positive to the left."""
    return _retarget.edit_turn(_checked(clip), checked_number(degrees, "degrees"), dict(options),
                               data_dir)


@with_options("EditOptions")
def move(clip: Clip, x: float, y: float, *, data_dir: StrPath | None = None,
         **options: Unpack[_options.EditOptions]) -> Clip:
    """Moves the motion over the ground, metres (axes: docs/editing.md)."""
    return _retarget.edit_move(_checked(clip), checked_number(x, "x"), checked_number(y, "y"),
                               dict(options), data_dir)


@with_options("LoopOptions", "EditOptions")
def loop(clip: Clip, *, data_dir: StrPath | None = None,
         **options: Unpack[_options.LoopEditOptions]) -> Clip:
    """Makes a seamless cycle from the first frame to the most similar one.

    Raises:
        RunError: the ends do not match, unless `force` is given.
    """
    return _retarget.edit_loop(_checked(clip), dict(options), data_dir)


@with_options("ConcatenateOptions", "EditOptions")
def concatenate(clips: Sequence[Clip], *, data_dir: StrPath | None = None,
                **options: Unpack[_options.ConcatenateEditOptions]) -> Clip:
    """Joins clips where they fit best, on the first clip's skeleton.

    Raises:
        RunError: clips that do not fit, unless `force` is given.
    """
    if not isinstance(clips, Iterable):
        raise ArgumentTypeError(f"clips: expected a list of Clips, found {type(clips).__name__}")
    checked = [_checked(clip, f"clips[{i}]") for i, clip in enumerate(clips)]
    return _retarget.edit_concatenate(checked, dict(options), data_dir)


@with_options("PathOptions", "EditOptions")
def follow_path(clip: Clip, to: StrPath | None = None, *, data_dir: StrPath | None = None,
                **options: Unpack[_options.PathEditOptions]) -> Clip:
    """Returns the motion along another path: `line`, `circle`, `figure8`, a JSON file.

    Raises:
        RunError: the path is too fast for the motion.
    """
    return _retarget.edit_follow_path(_checked(clip), {"to": to, **options}, data_dir)
