"""The published class `GeneralMotionRetargeting` (GMR) on the engine of retarget.

One word of an import changes:

    from retarget.gmr import GeneralMotionRetargeting
    from retarget.gmr.utils.lafan1 import load_bvh_file

The results equal those of the published class, frame by frame. docs/migrating_from_gmr.md lists
the correspondences.
"""

from __future__ import annotations

from retarget.gmr.data_loader import load_robot_motion
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
    "ROBOT_BASE_DICT",
    "ROBOT_XML_DICT",
    "RobotMotionViewer",
    "VIEWER_CAM_DISTANCE_DICT",
    "load_robot_motion",
]
