"""What `retarget edit` does: clips in, clips out (docs/editing.md).

Every function gives a new clip. Options say how the human in the clip is recognised and which part
of it is taken; what was guessed and may be wrong is warned of (RetargetWarning).
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from retarget import _retarget
from retarget._errors import UsageError
from retarget._signatures import with_options

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from retarget import _options
    from retarget._retarget import Clip

StrPath = str | os.PathLike[str]


def trim(clip: Clip, *, start: float | None = None, end: float | None = None,
         frames: str | slice | None = None) -> Clip:
    """A part of a clip: by times (seconds, inclusive) or by frames (`"a:b"` or a slice)."""
    if isinstance(frames, slice):
        if frames.step not in (None, 1):
            raise UsageError("frames: a slice with a step; resample() gives fewer frames")
        frames = ":".join("" if end is None else str(end) for end in (frames.start, frames.stop))
    return _retarget.edit_trim(clip, {"start": start, "end": end, "frames": frames})


def resample(clip: Clip, fps: float | None = None, *, speed: float | None = None,
             interpolation: Literal["linear", "cubic"] = "cubic",
             no_antialias: bool = False) -> Clip:
    """A clip at another rate (frames per second), or `speed` times as fast, or both."""
    if fps is None and speed is None:
        raise UsageError("resample() needs fps or speed")
    _one_of("interpolation", interpolation, ("linear", "cubic"))
    return _retarget.edit_resample(clip, fps, speed, interpolation == "linear", not no_antialias)


def rest(clip: Clip, like: Clip) -> Clip:
    """The same movement on a skeleton of the same joints with another rest pose: that of `like`."""
    return _retarget.edit_rest(clip, like)


@with_options("EditOptions")
def transfer(clip: Clip, like: Clip, *, data_dir: StrPath | None = None,
             **options: Unpack[_options.EditOptions]) -> Clip:
    """A clip on another skeleton, that of `like`, moved through the T-pose."""
    return _retarget.edit_transfer(clip, like, dict(options), _folder(data_dir))


@with_options("EditOptions")
def lafan1(clip: Clip, *, data_dir: StrPath | None = None,
           **options: Unpack[_options.EditOptions]) -> Clip:
    """A clip in the shape of LAFAN1: its joints, names, axes and size."""
    return _retarget.edit_lafan1(clip, dict(options), _folder(data_dir))


@with_options("EditOptions")
def mirror(clip: Clip, *, data_dir: StrPath | None = None,
           **options: Unpack[_options.EditOptions]) -> Clip:
    """The mirror image: left does what right did."""
    return _retarget.edit_mirror(clip, dict(options), _folder(data_dir))


@with_options("EditOptions")
def ground(clip: Clip, floor: float | None = None, *, data_dir: StrPath | None = None,
           **options: Unpack[_options.EditOptions]) -> Clip:
    """Raised or lowered so that the floor is at height 0.

    Args:
        floor: its height in the clip, metres; None: where the feet stand.
    """
    return _retarget.edit_ground(clip, floor, dict(options), _folder(data_dir))


@with_options("EditOptions")
def turn(clip: Clip, degrees: float, *, data_dir: StrPath | None = None,
         **options: Unpack[_options.EditOptions]) -> Clip:
    """Turned about the vertical where the motion begins; positive to the left."""
    return _retarget.edit_turn(clip, degrees, dict(options), _folder(data_dir))


@with_options("EditOptions")
def move(clip: Clip, x: float, y: float, *, data_dir: StrPath | None = None,
         **options: Unpack[_options.EditOptions]) -> Clip:
    """Moved over the ground, metres (docs/editing.md has the axes)."""
    return _retarget.edit_move(clip, x, y, dict(options), _folder(data_dir))


@with_options("EditOptions")
def loop(clip: Clip, *, shortest: float = 0.0, times: int = 1, in_place: bool = False,
         threshold: float = 0.2, force: bool = False, data_dir: StrPath | None = None,
         **options: Unpack[_options.EditOptions]) -> Clip:
    """A cycle from the first frame to the one most like it, without a seam.

    Args:
        shortest: seconds; 0: half the clip.
        times: how often the cycle is played.
        in_place: the body neither advances nor turns.
        threshold: largest distance of the seam, metres.
        force: also where the ends do not fit, which raises RunError otherwise.
    """
    return _retarget.edit_loop(clip, shortest, times, in_place, threshold, force, dict(options),
                               _folder(data_dir))


@with_options("EditOptions")
def concatenate(clips: Sequence[Clip], *, search: float | str | None = None,
                window: float = 1.0 / 3.0, blend: Literal["crossfade", "inertial"] = "crossfade",
                threshold: float = 0.2, force: bool = False, data_dir: StrPath | None = None,
                **options: Unpack[_options.EditOptions]) -> Clip:
    """Clips as one, joined where they fit best; on the first one's skeleton.

    Args:
        search: seconds at the end of one and the beginning of the next in which the seam is
            searched, or "all"; None: 2, and more while no seam is good.
        window: length of the part compared and blended, seconds.
        blend: mix the frames that both have, or fade out the difference in the second.
        threshold: largest distance of a seam, metres.
        force: also where clips do not fit, which raises RunError otherwise.
    """
    _one_of("blend", blend, ("crossfade", "inertial"))
    text = "" if search is None else str(search)
    return _retarget.edit_concatenate(list(clips), text, window, blend, threshold, force,
                                      dict(options), _folder(data_dir))


@with_options("EditOptions")
def follow_path(clip: Clip, to: StrPath | None = None, *, radius: float = 3.0, scale: float = 1.0,
                rotate: float = 0.0, keep: Literal["time", "speed", "stride"] = "time",
                tolerance: float = 0.05, force: bool = False, data_dir: StrPath | None = None,
                **options: Unpack[_options.EditOptions]) -> Clip:
    """A motion along another path over the ground.

    Args:
        to: `line`, `circle` or `figure8`, as long as the clip's own; a JSON file of a path; None:
            its own, scaled or turned.
        radius: of a circle, metres; negative: to the right.
        scale: larger or smaller, from its beginning.
        rotate: about its beginning, degrees to the left.
        keep: what stays on a longer or shorter path: the duration, the speed, or the strides.
        tolerance: how far the fitted path may be from the track, metres.
        force: also where the path is too fast, which raises RunError otherwise.
    """
    _one_of("keep", keep, ("time", "speed", "stride"))
    return _retarget.edit_follow_path(clip, to, radius, scale, rotate, keep, tolerance, force,
                                      dict(options), _folder(data_dir))


def _one_of(name: str, value: object, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise UsageError(f"{name}: expected one of {', '.join(choices)}, found {value!r}")


def _folder(data_dir: StrPath | None) -> str:
    return "" if data_dir is None else os.fspath(data_dir)
