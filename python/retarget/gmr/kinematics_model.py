"""The published class `KinematicsModel`, in numpy: torch is not needed."""

from __future__ import annotations

import os
import pathlib
import warnings
from typing import Any

import numpy as np

from retarget import _retarget
from retarget._errors import RetargetWarning, UsageError

_ROOT_SIZE = 7


class KinematicsModel:
    """Forward kinematics of a robot's model, for arrays or tensors.

    Arrays give float64 arrays. Tensors of torch give tensors of their type on their device.
    Positions are metres and rotations unit quaternions x y z w, both in the world frame, as in the
    published class. Values of joints are radians; metres for slide joints.

    Args:
        file_path: MJCF file of a robot.
        device: the device of the tensors that get_dof_limits() and parent_indices return; None:
            they are arrays.

    Raises:
        ConfigError: the model cannot be read; FileNotFoundError as well if it is missing.
    """

    def __init__(self, file_path: str | os.PathLike[str], device: Any = None) -> None:
        self._device = device
        self._file_path = os.fsdecode(file_path)
        profile = pathlib.Path(self._file_path).parent / "robot.json"
        with warnings.catch_warnings():
            # Unknown soles and the like do not matter here.
            warnings.simplefilter("ignore", RetargetWarning)
            self._robot = _retarget.Robot(
                robot_xml=self._file_path,
                robot_profile=str(profile) if profile.is_file() else None)

    @property
    def body_names(self) -> list[str]:
        """B names, in depth-first order, the root first, without the world."""
        return self._robot.body_names[1:]

    @property
    def num_joint(self) -> int:
        """B, as in the published class, which has a joint for each body."""
        return len(self.body_names)

    @property
    def num_dof(self) -> int:
        """Number of joint values."""
        return len(self._robot.qpos_names)

    @property
    def dof_names(self) -> list[str]:
        """Names of the joints, in the order of dof_pos."""
        return self._robot.qpos_names

    @property
    def joint_dof_idx(self) -> list[int]:
        """Index of each body's first joint in dof_pos; -1 for a body without joints."""
        first = [-1] * self.num_joint
        for joint, body in reversed(list(enumerate(self._robot.qpos_bodies))):
            first[body - 1] = joint
        return first

    @property
    def parent_indices(self) -> Any:
        """(B,) int64: parent index per body; -1 for the root."""
        return self._given_back(np.array(self._robot.body_parents[1:], dtype=np.int64) - 1)

    def get_parent_idx(self, idx: int) -> Any:
        """Index of a body's parent; -1 for the root."""
        return self.parent_indices[idx]

    def get_body_idx(self, body_name: str) -> int:
        """Index of a body. Raises ValueError: no body has this name."""
        return self.body_names.index(body_name)

    def get_dof_limits(self) -> tuple[Any, Any]:
        """(num_dof,) lower and (num_dof,) upper ranges of the model, rad or m; infinite: none."""
        ranges = dict(zip(self._robot.joint_names, self._robot.joint_limits("model")))
        none = np.array([-np.inf, np.inf])
        limits = np.array([ranges.get(name, none) for name in self.dof_names]).reshape(-1, 2)
        return self._given_back(limits[:, 0].copy()), self._given_back(limits[:, 1].copy())

    def forward_kinematics(self, root_pos: Any, root_rot: Any, dof_pos: Any,
                           fitted_shape: None = None) -> tuple[Any, Any]:
        """Computes the poses of all bodies.

        Args:
            root_pos: (..., 3), metres.
            root_rot: (..., 4), quaternions x y z w.
            dof_pos: (..., num_dof), in the model's order.
            fitted_shape: only None; scaled bodies are not supported.

        Returns:
            Positions (..., B, 3) and rotations (..., B, 4) x y z w.

        Raises:
            UsageError: other shapes, numbers that are not finite, a zero quaternion.
        """
        if fitted_shape is not None:
            raise UsageError("fitted_shape: scaled bodies are not supported")
        position, rotation, joints = (_array(each) for each in (root_pos, root_rot, dof_pos))
        leading = joints.shape[:-1]
        expected = {"root_pos": (position, 3), "root_rot": (rotation, 4),
                    "dof_pos": (joints, self.num_dof)}
        for name, (array, size) in expected.items():
            if array.shape != (*leading, size):
                raise UsageError(f"{name}: expected shape {(*leading, size)}, found {array.shape}")
        qpos = np.concatenate([position, rotation[..., [3, 0, 1, 2]], joints], axis=-1)
        # The engine has the world as its first body.
        positions, rotations = self._robot.forward_kinematics(
            qpos.reshape(-1, _ROOT_SIZE + self.num_dof))
        bodies = self.num_joint
        return (_like(root_pos, positions[:, 1:].reshape(*leading, bodies, 3)),
                _like(root_pos, rotations[:, 1:][..., [1, 2, 3, 0]].reshape(*leading, bodies, 4)))

    def _given_back(self, array: np.ndarray) -> Any:
        if self._device is None or not _has_torch():
            return array
        import torch  # type: ignore

        narrow = array.astype(np.float32) if array.dtype.kind == "f" else array
        return torch.from_numpy(narrow).to(self._device)


def _has_torch() -> bool:
    try:
        import torch  # type: ignore # noqa: F401
    except ImportError:
        return False
    return True


def _array(value: Any) -> np.ndarray:
    if hasattr(value, "detach"):  # a tensor
        value = value.detach().cpu().numpy()
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise UsageError(f"expected numbers, found {type(value).__name__}") from None


def _like(given: Any, array: np.ndarray) -> Any:
    """Returns a tensor if a tensor was given."""
    if not hasattr(given, "detach"):
        return array
    import torch  # type: ignore

    return torch.as_tensor(np.array(array)).to(dtype=given.dtype, device=given.device)
