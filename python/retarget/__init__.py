"""Human motion capture to joint trajectories of humanoid robots.

    import retarget

    clip = retarget.load("walk.bvh")
    motion = retarget.to_robot(clip, "unitree_g1")
    motion.save("walk.npz", format="npz-mjlab")

The options are those of the command `retarget`, as keywords: `--source-fps 30` is `source_fps=30`.
"""

from retarget import edit
from retarget._api import batch, evaluate, inspect, load, load_motion, to_robot
from retarget._errors import (
    ConfigError, Error, InputError, RetargetWarning, RunError, UsageError)
from retarget._results import Batch, Fault, Inspection, Report
from retarget._retarget import Clip, Motion, Robot, metrics, version_number, version_text

__version__ = version_number()

__all__ = [
    "Batch", "Clip", "ConfigError", "Error", "Fault", "InputError", "Inspection", "Motion",
    "Report", "RetargetWarning", "Robot", "RunError", "UsageError", "__version__", "batch", "edit",
    "evaluate", "inspect", "load", "load_motion", "metrics", "to_robot", "version_text",
]
