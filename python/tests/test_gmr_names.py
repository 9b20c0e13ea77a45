"""Names of the published package: kinematics in numpy, and names that retarget lacks."""

from __future__ import annotations

import subprocess
import sys
import types
from pathlib import Path

import numpy as np
import pytest

import retarget
import retarget.gmr
from retarget.gmr import KinematicsModel


@pytest.fixture(scope="module")
def model(g1: retarget.Robot) -> KinematicsModel:
    return KinematicsModel(g1.model, device="cpu")


def test_kinematics(model: KinematicsModel, walked: retarget.Motion, g1: retarget.Robot) -> None:
    positions, rotations = model.forward_kinematics(
        walked.root_position, walked.root_rotation_xyzw, walked.qpos[:, 7:])
    assert positions.shape == (len(walked), model.num_joint, 3)
    assert rotations.shape == (len(walked), model.num_joint, 4)
    expected = g1.forward_kinematics(walked.qpos)
    np.testing.assert_array_equal(positions, expected[0][:, 1:])
    np.testing.assert_array_equal(rotations[..., [3, 0, 1, 2]], expected[1][:, 1:])
    # One frame, and frames of batches.
    one = model.forward_kinematics(walked.root_position[9], walked.root_rotation_xyzw[9],
                                   walked.qpos[9, 7:])
    np.testing.assert_array_equal(one[0], positions[9])
    folded = model.forward_kinematics(walked.root_position[:300].reshape(3, 100, 3),
                                      walked.root_rotation_xyzw[:300].reshape(3, 100, 4),
                                      walked.qpos[:300, 7:].reshape(3, 100, 29))
    np.testing.assert_array_equal(folded[1].reshape(-1, model.num_joint, 4), rotations[:300])


def test_the_tree(model: KinematicsModel, g1: retarget.Robot) -> None:
    assert model.body_names == g1.body_names[1:] and model.body_names[0] == "pelvis"
    assert model.num_dof == 29 and model.dof_names == g1.joint_names
    parents = np.asarray(model.parent_indices)
    assert parents[0] == -1 and (parents[1:] < np.arange(1, len(parents))).all()
    knee = model.get_body_idx("left_knee_link")
    assert model.body_names[int(model.get_parent_idx(knee))] == "left_hip_yaw_link"
    indices = model.joint_dof_idx
    assert indices[0] == -1 and sorted(i for i in indices if i >= 0) == list(range(29))
    assert model.dof_names[indices[knee]] == "left_knee_joint"
    lower, upper = (np.asarray(each) for each in model.get_dof_limits())
    np.testing.assert_allclose(np.stack([lower, upper], axis=1), g1.joint_limits("model"), rtol=1e-6)


def test_wrong_kinematics(model: KinematicsModel, walked: retarget.Motion) -> None:
    good = (walked.root_position, walked.root_rotation_xyzw, walked.qpos[:, 7:])
    for wrong, text in (((good[0][1:], *good[1:]), r"root_pos: expected shape \(301, 3\)"),
                        ((good[0], good[1][:, :3], good[2]), "root_rot: expected shape"),
                        ((*good[:2], good[2][:, 1:]), "dof_pos: expected shape"),
                        ((*good[:2], "x"), "expected numbers")):
        with pytest.raises(retarget.UsageError, match=text):
            model.forward_kinematics(*wrong)
    with pytest.raises(FileNotFoundError):
        KinematicsModel("nowhere.xml", "cpu")


class FakeTensor:
    """The members of a tensor that the class uses."""

    dtype, device = "float32", "cpu"

    def __init__(self, array: np.ndarray) -> None:
        self.array = array

    def detach(self) -> FakeTensor:
        return self

    def cpu(self) -> FakeTensor:
        return self

    def numpy(self) -> np.ndarray:
        return self.array

    def to(self, dtype: str, device: str) -> FakeTensor:
        return FakeTensor(self.array.astype(dtype))


def test_tensors_give_tensors(model: KinematicsModel, walked: retarget.Motion,
                              monkeypatch: pytest.MonkeyPatch) -> None:
    torch = types.ModuleType("torch")
    torch.as_tensor = FakeTensor  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "torch", torch)
    given = (walked.root_position, walked.root_rotation_xyzw, walked.qpos[:, 7:])
    positions, rotations = model.forward_kinematics(*(FakeTensor(each) for each in given))
    assert isinstance(positions, FakeTensor) and positions.array.dtype == np.float32
    np.testing.assert_allclose(positions.array, model.forward_kinematics(*given)[0], atol=1e-6)
    assert rotations.array.shape == (301, model.num_joint, 4)


def test_other_names_need_the_published_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "general_motion_retargeting", None)
    with pytest.raises(AttributeError, match="retarget.gmr.*'human_head_to_robot'.*not installed"):
        retarget.gmr.human_head_to_robot
    with pytest.raises(ImportError):
        from retarget.gmr import human_head_to_robot  # noqa: F401
    assert not hasattr(retarget.gmr, "__wrapped__")


def test_other_names_come_from_the_published_package(tmp_path: Path) -> None:
    package = tmp_path / "general_motion_retargeting"
    package.mkdir()
    (package / "__init__.py").write_text("human_head_to_robot = 42\n")
    code = ("import sys; sys.path.insert(0, sys.argv[1]); import retarget.gmr as gmr;"
            "assert 'general_motion_retargeting' not in sys.modules;"
            "from retarget.gmr import human_head_to_robot; assert human_head_to_robot == 42;"
            "assert gmr.GeneralMotionRetargeting.__module__.startswith('retarget.');"
            "\ntry: gmr.nothing\nexcept AttributeError as error: print(error)")
    done = subprocess.run([sys.executable, "-c", code, str(tmp_path)], text=True,
                          capture_output=True, timeout=100)
    assert done.returncode == 0, done.stderr
    assert "neither retarget.gmr nor general_motion_retargeting has 'nothing'" in done.stdout
