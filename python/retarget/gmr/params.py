"""The published dictionaries: models, retargeting configurations, root bodies, by robot.

They are plain dictionaries of paths: more entries may be added, as with the published package.
retarget includes the models and the tables of LAFAN1. The other tables (SMPL-X, FBX, ...) belong to
the published package. They are found if it is installed, in the checkout named by the environment
variable RETARGET_GMR_ROOT, or by use_published_files().
"""

from __future__ import annotations

import importlib.util
import os
import pathlib

from retarget import _retarget
from retarget._errors import UsageError

_DATA = pathlib.Path(_retarget.data_folder(""))

IK_CONFIG_ROOT = _DATA / "configs"
"""The folder of retarget's own retargeting configurations."""
ASSET_ROOT = _DATA / "robots"
"""The folder of retarget's own robots."""

# By robot: its name in the file names of tables, the paths of its model in the published assets,
# its root body, and the camera distance in metres.
_ROBOTS: dict[str, tuple[str, tuple[str, ...], str, float]] = {
    "unitree_g1": ("g1", ("unitree_g1/g1_mocap_29dof.xml",), "pelvis", 2.0),
    "unitree_g1_with_hands": (
        "g1", ("unitree_g1/g1_mocap_29dof_with_hands.xml",), "pelvis", 2.0),
    "unitree_h1": ("h1", ("unitree_h1/h1.xml",), "pelvis", 3.0),
    "unitree_h1_2": ("h1_2", ("unitree_h1_2/h1_2_handless.xml",), "pelvis", 3.0),
    "booster_t1": (
        "t1", ("booster_t1/T1_serial.xml", "booster_t1/t1_mocap.xml"), "Waist", 2.0),
    "booster_t1_29dof": ("t1_29dof", ("booster_t1_29dof/t1_mocap.xml",), "Waist", 2.0),
    "stanford_toddy": ("toddy", ("stanford_toddy/toddy_mocap.xml",), "waist_link", 1.0),
    "fourier_n1": ("n1", ("fourier_n1/n1_mocap.xml",), "base_link", 2.0),
    "engineai_pm01": ("pm01", ("engineai_pm01/pm_v2.xml",), "LINK_BASE", 2.0),
    "kuavo_s45": ("kuavo", ("kuavo_s45/biped_s45_collision.xml",), "base_link", 3.0),
    "hightorque_hi": ("hi", ("hightorque_hi/hi_25dof.xml",), "base_link", 2.0),
    "galaxea_r1pro": ("r1pro", ("galaxea_r1pro/r1_pro.xml",), "torso_link4", 3.0),
    "berkeley_humanoid_lite": (
        "bhl", ("berkeley_humanoid_lite/bhl_scene.xml",
                "berkeley_humanoid_lite/berkeley_humanoid_lite.xml"), "imu_2", 2.0),
    "booster_k1": ("k1", ("booster_k1/K1_serial.xml",), "Trunk", 2.0),
    "pnd_adam_lite": (
        "adam", ("pnd_adam_lite/scene.xml", "pnd_adam_lite/adam_lite.xml"), "pelvis", 3.0),
    "tienkung": ("tienkung", ("tienkung/mjcf/tienkung.xml", "tienkung/tienkung.xml"),
                 "Base_link", 3.0),
    "tiekung_2_0": (
        "tienkung2pro", ("tiekung_2_0/mjcf/walker_tienkung_ei_fk.xml",), "pelvis", 3.0),
    "pal_talos": ("talos", ("pal_talos/talos.xml",), "base_link", 3.0),
    "fourier_gr3": (
        "gr3", ("fourier_gr3v2_1_1/mjcf/gr3v2_1_1_dummy_hand.xml",), "base_link", 2.0),
}

# Human formats of the published tables; "bvh" is the older name of LAFAN1.
_LAFAN1 = ("bvh_lafan1", "bvh")
_HUMANS = ("smplx", *_LAFAN1, "bvh_nokov", "bvh_xsens", "fbx", "fbx_offline", "xrobot", "xsens_mvn")

ROBOT_XML_DICT: dict[str, pathlib.Path] = {}
"""Maps the published name of a robot to its model."""
IK_CONFIG_DICT: dict[str, dict[str, pathlib.Path]] = {human: {} for human in _HUMANS}
"""Maps the name of a source, then that of a robot, to the configuration."""
ROBOT_BASE_DICT: dict[str, str] = {name: base for name, (_, _, base, _) in _ROBOTS.items()}
"""Maps the name of a robot to its root body."""
VIEWER_CAM_DISTANCE_DICT: dict[str, float] = {
    name: distance for name, (_, _, _, distance) in _ROBOTS.items()}
"""The distance of the viewer's camera for each robot, metres."""


def _use_own_files() -> None:
    for name in _ROBOTS:
        for model in (ASSET_ROOT / name / "model.xml",
                      ASSET_ROOT / "unverified" / name / "model.xml"):
            if model.is_file():
                ROBOT_XML_DICT.setdefault(name, model)
        config = IK_CONFIG_ROOT / f"lafan1_to_{name}.json"
        if config.is_file():
            for human in _LAFAN1:
                IK_CONFIG_DICT[human].setdefault(name, config)


def use_published_files(ik_configs: str | os.PathLike[str],
                        assets: str | os.PathLike[str] | None = None) -> int:
    """Registers tables and models of the published package that retarget lacks.

    Existing entries are kept.

    Args:
        ik_configs: the folder of its tables (`smplx_to_g1.json`, ...).
        assets: the folder of its robots; None: only tables.

    Returns:
        The number of new entries.
    """
    folder = pathlib.Path(ik_configs)
    if not folder.is_dir():
        raise UsageError(f"ik_configs: there is no folder {folder}")
    new = 0
    for name, (short, models, _, _) in _ROBOTS.items():
        for human in _HUMANS:
            stems = (f"{human}_to_{short}", f"bvh_to_{short}")
            for stem in stems if human in _LAFAN1 else stems[:1]:
                config = folder / f"{stem}.json"
                if name not in IK_CONFIG_DICT[human] and config.is_file():
                    IK_CONFIG_DICT[human][name] = config
                    new += 1
        for model in models if assets is not None else ():
            path = pathlib.Path(assets or "") / model
            if name not in ROBOT_XML_DICT and path.is_file():
                ROBOT_XML_DICT[name] = path
                new += 1
    return new


def _find_published_files() -> None:
    package = "general_motion_retargeting"
    named = os.environ.get("RETARGET_GMR_ROOT")
    if named:
        root = pathlib.Path(named)
        folders: tuple[pathlib.Path, ...] = (root / package, root)
        if not any((folder / "ik_configs").is_dir() for folder in folders):
            raise UsageError(f"RETARGET_GMR_ROOT: no folder ik_configs in {folders[0]} or {root}")
    else:
        try:
            spec = importlib.util.find_spec(package)  # does not import it
        except (ImportError, ValueError):  # a foreign importer fails, or a module has no spec
            spec = None
        folders = tuple(pathlib.Path(place) for place in
                        (spec.submodule_search_locations or () if spec else ()))
    for folder in folders:
        if (folder / "ik_configs").is_dir():
            assets = folder.parent / "assets"
            use_published_files(folder / "ik_configs", assets if assets.is_dir() else None)


_use_own_files()
_find_published_files()
