"""The published class `GeneralMotionRetargeting` (GMR) on the engine of retarget.

One word of an import changes:

    from retarget.gmr import GeneralMotionRetargeting
    from retarget.gmr.utils.lafan1 import load_bvh_file

The results equal those of the published class, frame by frame. docs/migrating_from_gmr.md lists
the correspondences. Other names are those of the package `general_motion_retargeting`, if it is
installed: `from retarget.gmr import draw_frame` imports it on first use.
"""

from __future__ import annotations

import importlib
from typing import Any

from retarget.gmr.data_loader import load_robot_motion
from retarget.gmr.kinematics_model import KinematicsModel
from retarget.gmr.motion_retarget import GeneralMotionRetargeting
from retarget.gmr.params import (
    ASSET_ROOT,
    IK_CONFIG_DICT,
    IK_CONFIG_ROOT,
    ROBOT_BASE_DICT,
    ROBOT_XML_DICT,
    VIEWER_CAM_DISTANCE_DICT,
)
from retarget.gmr.robot_motion_viewer import RobotMotionViewer

__all__ = [
    "ASSET_ROOT",
    "GeneralMotionRetargeting",
    "IK_CONFIG_DICT",
    "IK_CONFIG_ROOT",
    "KinematicsModel",
    "ROBOT_BASE_DICT",
    "ROBOT_XML_DICT",
    "RobotMotionViewer",
    "VIEWER_CAM_DISTANCE_DICT",
    "load_robot_motion",
]

_PUBLISHED = "general_motion_retargeting"


def __getattr__(name: str) -> Any:
    """Returns a name that retarget lacks from the published package.

    Raises AttributeError: the package is not installed, or lacks the name, too.
    """
    if name.startswith("__"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        published = importlib.import_module(_PUBLISHED)
    except ModuleNotFoundError as error:
        if error.name != _PUBLISHED:  # It is installed, but one of its dependencies is not.
            raise AttributeError(f"{__name__} has no {name!r}, and {_PUBLISHED} cannot be "
                                 f"imported: {error}") from error
        raise AttributeError(f"{__name__} has no {name!r}; names that retarget lacks come from "
                             f"{_PUBLISHED}, which is not installed") from None
    try:
        return getattr(published, name)
    except AttributeError:
        raise AttributeError(f"neither {__name__} nor {_PUBLISHED} has {name!r}") from None
