"""The published kinematics in torch are not part of retarget."""

from __future__ import annotations

from typing import Any, NoReturn


class KinematicsModel:
    """Raises NotImplementedError: see retarget.Robot.forward_kinematics."""

    def __init__(self, *args: Any, **kwargs: Any) -> NoReturn:
        raise NotImplementedError(
            "retarget has no kinematics in torch: retarget.Robot(name).forward_kinematics(qpos) "
            "gives the poses of all bodies")
