"""Clips from arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from retarget import _retarget
from retarget._errors import UsageError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def check_names(names: Sequence[str]) -> None:
    """Raises UsageError unless `names` is a sequence of strings."""
    if isinstance(names, str) or not all(isinstance(each, str) for each in names):
        raise UsageError("names: expected a sequence of strings")


def checked_rate(fps: float) -> float:
    """Returns frames per second as a float, without a range check."""
    try:
        return float(fps)
    except (TypeError, ValueError, OverflowError):
        raise UsageError(f"fps: expected frames per second, found {fps!r}") from None


def clip_from_positions(positions: ArrayLike, names: Sequence[str] | None = None, *, fps: float,
                        name: str = "positions") -> _retarget.Clip:
    """See Clip.from_positions."""
    if names is not None:
        check_names(names)
        if len(names) == 0:
            raise UsageError("names: expected at least one joint, or None")
    if not isinstance(name, str):
        raise UsageError(f"name: expected a string, found {name!r}")
    return _retarget.clip_from_positions(positions, list(names or []), checked_rate(fps), name)


def clip_from_arrays(names: Sequence[str], parents: Sequence[int], positions: ArrayLike, *,
                     rotations_wxyz: ArrayLike | None = None,
                     rotations_xyzw: ArrayLike | None = None, fps: float,
                     space: Literal["world", "local"] = "world",
                     name: str = "arrays") -> _retarget.Clip:
    """See Clip.from_arrays."""
    if space not in ("world", "local"):
        raise UsageError(f'space: expected "world" or "local", found {space!r}')
    if rotations_wxyz is None and rotations_xyzw is None:
        raise UsageError("give rotations_wxyz or rotations_xyzw; Clip.from_positions takes "
                         "positions alone")
    if rotations_wxyz is not None and rotations_xyzw is not None:
        raise UsageError("rotations_wxyz and rotations_xyzw are both given: give only one of them")
    scalar_first = rotations_wxyz is not None
    rotations = rotations_wxyz if scalar_first else rotations_xyzw
    check_names(names)
    if len(parents) != len(names):
        raise UsageError(f"parents: expected {len(names)} of them, one for each name, "
                         f"found {len(parents)}")
    fps = checked_rate(fps)
    if not isinstance(name, str):
        raise UsageError(f"name: expected a string, found {name!r}")
    try:
        indices = [-1 if each is None else each.__index__() for each in parents]
    except (AttributeError, TypeError):
        raise UsageError("parents: expected whole numbers, -1 for the root") from None
    for joint, parent in enumerate(indices):
        if not -1 <= parent < len(indices):
            raise UsageError(f"parents[{joint}]: expected -1 to {len(indices) - 1}, found {parent}")
    return _retarget.clip_from_arrays(list(names), indices, positions, rotations, scalar_first,
                                      space == "local", fps, name)
