"""Robot motions saved by the published scripts."""

from __future__ import annotations

import io
import os
import pickle
import re
from typing import Any

import numpy as np

from retarget._errors import InputError

# Pickles of numpy arrays need only these modules and names; nothing else is called. numpy 2 renamed its
# core, and a pickle may contain either name.
_CORE = "numpy._core" if int(np.__version__.split(".")[0]) >= 2 else "numpy.core"
_MODULES = {"numpy", "numpy.core.multiarray", "numpy._core.multiarray", "numpy.core.numeric",
            "numpy._core.numeric"}
_NAMES = {"ndarray", "dtype", "_reconstruct", "scalar", "_frombuffer"}


class _ArraysOnly(pickle.Unpickler):
    def find_class(self, module: str, name: str) -> Any:
        if module in _MODULES and name in _NAMES:
            core = re.sub(r"^numpy\._?core\b", _CORE, module)
            return super().find_class(core, name)
        raise InputError("a motion contains only arrays and numbers, but this pickle requests "
                         f"{module}.{name}")


def _array(motion: dict[str, Any], key: str, path: str, last: int | None) -> np.ndarray:
    if key not in motion:
        raise InputError(f'{path}: there is no "{key}" in the motion')
    array = np.asarray(motion[key])
    if array.ndim != 2 or array.dtype.kind not in "fiu" or (last and array.shape[1] != last):
        shape = f"(frames, {last or 'joints'})"
        raise InputError(f'{path}: expected "{key}" to be numbers {shape}, found '
                         f"{array.dtype} {array.shape}")
    return array


def load_robot_motion(motion_file: str | os.PathLike[str]) -> tuple[
        dict[str, Any], float, np.ndarray, np.ndarray, np.ndarray, Any, Any]:
    """Reads a robot motion from a pickle. Only arrays are read, no code runs.

    Returns:
        (motion, fps, root_pos, root_rot, dof_pos, local_body_pos, link_body_list), where motion is
        the whole dictionary, fps frames per second (30 if the file has none), root_pos (F, 3) in
        metres, root_rot (F, 4) quaternions w x y z, dof_pos (F, N) in radians; the last two may be
        None.
    """
    path = os.fsdecode(motion_file)
    with open(path, "rb") as file:
        content = file.read()
    try:
        motion = _ArraysOnly(io.BytesIO(content)).load()
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    except Exception as error:
        raise InputError(f"{path}: not the pickle of a motion: {error}") from None
    if not isinstance(motion, dict):
        raise InputError(f"{path}: expected a dictionary, found {type(motion).__name__}")
    fps = np.asarray(motion.get("fps", motion.get("mocap_frame_rate", 30.0))).ravel()
    if fps.size < 1 or fps.dtype.kind not in "fiu":
        raise InputError(f"{path}: the frame rate is not a number")
    root_rot = _array(motion, "root_rot", path, 4)[:, [3, 0, 1, 2]]
    return (motion, fps[0].item(), _array(motion, "root_pos", path, 3), root_rot,
            _array(motion, "dof_pos", path, None), motion.get("local_body_pos"),
            motion.get("link_body_list"))
