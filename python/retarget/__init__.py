"""Human motion capture to joint trajectories of humanoid robots.

    import retarget

    clip = retarget.load("walk.bvh")
    motion = retarget.to_robot(clip, "unitree_g1", format="npz-mjlab")
    motion.save("walk.npz", format="npz-mjlab")

The options are those of the command `retarget`, as keywords: `--source-fps 30` is `source_fps=30`.
"""

from retarget import edit
from retarget._api import (
    batch, evaluate, inspect, load, load_motion, make_plan, solve, to_robot)
from retarget._certify import Certificate, certify
from retarget._errors import (
    ConfigError, Error, InputError, MissingConfigError, MissingInputError, RetargetWarning,
    RunError, UsageError)
from retarget._files import (
    ColumnDifference, Comparison, RobotFacts, compare, convert, robot_facts, robots)
from retarget._folders import AddedRobot, add_robot, gallery, verify
from retarget._live import LiveSession, RobotFrame, live
from retarget._results import Batch, Fault, Inspection, Report
from retarget._retarget import (
    Clip, Motion, Plan, Robot, Scene, metrics, version_number, version_text)
from retarget._scenes import ContactLabels, SceneBody, SceneShape, load_scene
from retarget._serve import Server, play, serve
from retarget._simulate import Simulation, simulate
from retarget._view import Page, picture, view

__version__ = version_number()
"""`major.minor.patch`."""

__all__ = [
    "AddedRobot", "Batch", "Certificate", "Clip", "ColumnDifference", "Comparison",
    "ConfigError", "ContactLabels", "Error", "Fault", "InputError", "Inspection", "LiveSession",
    "MissingConfigError", "MissingInputError", "Motion", "Page", "Plan", "Report",
    "RetargetWarning", "Robot", "RobotFacts", "RobotFrame", "RunError", "Scene", "SceneBody",
    "SceneShape", "Server", "Simulation", "UsageError", "__version__", "add_robot", "batch",
    "certify", "compare", "convert", "edit", "evaluate", "gallery", "inspect", "live", "load",
    "load_motion", "load_scene", "make_plan", "metrics", "picture", "play", "robot_facts",
    "robots", "serve", "simulate", "solve", "to_robot", "verify", "version_text", "view",
]
