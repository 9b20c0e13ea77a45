"""The published viewer is not part of retarget."""

from __future__ import annotations

from typing import Any, NoReturn


class RobotMotionViewer:
    """Raises NotImplementedError: retarget opens no window."""

    def __init__(self, *args: Any, **kwargs: Any) -> NoReturn:
        raise NotImplementedError(
            "retarget opens no MuJoCo window: save the motion and look at it with `retarget view`, "
            "or keep importing RobotMotionViewer from general_motion_retargeting")


def draw_frame(*args: Any, **kwargs: Any) -> NoReturn:
    """Raises NotImplementedError, as RobotMotionViewer does."""
    RobotMotionViewer()
