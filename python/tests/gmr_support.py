"""Helpers for tests of retarget.gmr: sample frames, the tool, the shared data."""

from __future__ import annotations

import os
import pathlib
import subprocess

import numpy as np
import pytest

import retarget
from retarget.gmr import GeneralMotionRetargeting
from retarget.gmr.utils.lafan1 import load_bvh_file

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT / "data"


def shared_folder() -> pathlib.Path:
    """The folder with reference results; skips the test if it is missing."""
    folder = pathlib.Path(os.environ.get("RETARGET_SHARED") or ROOT.parent / "shared")
    if not (folder / "data").is_dir():
        pytest.skip("no folder of shared data: set RETARGET_SHARED to run this test")
    return folder


def sample_frames(name: str = "walk", count: int | None = None) -> list[dict]:
    """Frames of a sample clip, LAFAN1's bodies."""
    return load_bvh_file(DATA / f"{name}.bvh")[0][:count]


def make_retargeter(**changes) -> GeneralMotionRetargeting:
    """Returns a retargeter from LAFAN1 to the G1, with the height of the published package."""
    arguments = dict(src_human="bvh_lafan1", tgt_robot="unitree_g1", actual_human_height=1.75,
                     verbose=False)
    return GeneralMotionRetargeting(**(arguments | changes))


def tool_qpos(bvh: pathlib.Path, output: pathlib.Path, robot: str = "unitree_g1") -> np.ndarray:
    """(F, 7 + N) of the command's exact method: x y z, w x y z, joints."""
    package = pathlib.Path(retarget.__file__).parent
    tool = os.environ.get("RETARGET_TOOL") or package / "bin/retarget"
    if not pathlib.Path(tool).exists():
        pytest.skip("the command was not built")
    # Only the module needs the sanitizer library.
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    subprocess.run([str(tool), "--bvh", str(bvh), "--robot", robot, "--method", "gmr",
                    "--fps", "source", "--precision", "17", "--quiet", "-o", str(output)],
                   check=True, timeout=300, env=environment)
    return from_xyzw(np.loadtxt(output, delimiter=","))


def from_xyzw(rows: np.ndarray) -> np.ndarray:
    """Rows x y z, x y z w, joints with the quaternion as w x y z."""
    order = [0, 1, 2, 6, 3, 4, 5, *range(7, rows.shape[1])]
    return rows[:, order]


def same_signs(qpos: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Returns configurations with the quaternion signs of others."""
    signs = np.sign(np.sum(qpos[:, 3:7] * like[:, 3:7], axis=1, keepdims=True))
    return np.hstack([qpos[:, :3], qpos[:, 3:7] * signs, qpos[:, 7:]])
