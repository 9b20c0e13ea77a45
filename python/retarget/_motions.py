"""Motions from arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from retarget import _retarget
from retarget._clips import checked_rate
from retarget._errors import UsageError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def motion_from_qpos(qpos: ArrayLike, robot: Any, fps: float, contacts: ArrayLike | None = None, *,
                     name: str = "qpos") -> _retarget.Motion:
    """See Motion.from_qpos."""
    if not isinstance(robot, _retarget.Robot):
        robot = _retarget.Robot(robot)
    try:
        shape = np.shape(qpos)
    except ValueError:
        shape = ()  # A ragged list: the module explains it.
    size = len(robot.zero_configuration)
    if len(shape) == 2 and shape[1] != size:
        raise UsageError(
            f"qpos: expected shape (F, {size}): root x y z, root quaternion w x y z and the "
            f"{size - 7} joints of {robot.name or robot.model} in the model's order; "
            f"found {shape}")
    return _retarget.motion_from_qpos(qpos, robot, checked_rate(fps), contacts, name)
