"""Arrays: contents, memory ownership, accepted inputs."""

from __future__ import annotations

import gc
from pathlib import Path

import numpy as np
import pytest

import retarget


def test_a_motion_equals_its_csv(walked: retarget.Motion, tmp_path: Path) -> None:
    walked.save(tmp_path / "walk.csv")
    rows = np.loadtxt(tmp_path / "walk.csv", delimiter=",")
    frames, joints = len(walked), len(walked.joint_names)
    assert rows.shape == (frames, 7 + joints)
    arrays = np.hstack([walked.root_position, walked.root_rotation_xyzw, walked.joint_positions])
    np.testing.assert_allclose(arrays, rows, atol=5.1e-7)
    np.testing.assert_array_equal(walked.root_rotation_wxyz[:, [1, 2, 3, 0]],
                                  walked.root_rotation_xyzw)
    np.testing.assert_array_equal(walked.qpos[:, :3], walked.root_position)
    assert walked.fps == 30.0 and walked.frame_count == frames


def test_a_variant_has_its_joints_alone(walk: retarget.Clip) -> None:
    # The variant with 23 joints has its own model, the variant with 27 holds two joints.
    for joints, size in ((23, 30), (27, 36)):
        motion = retarget.to_robot(walk, "unitree_g1", dof=str(joints))
        assert motion.joint_positions.shape == (len(walk), joints)
        assert motion.qpos.shape == (len(walk), size)
        limits = motion.robot.joint_limits()
        assert limits.shape == (joints, 2)
        assert (motion.joint_positions >= limits[:, 0] - 1e-6).all()
        assert (motion.joint_positions <= limits[:, 1] + 1e-6).all()


def test_contacts(walked: retarget.Motion, walk: retarget.Clip, g1: retarget.Robot) -> None:
    contacts = walked.contacts
    assert contacts.dtype == bool and contacts.shape == (len(walked), 4)
    assert walked.contact_names == ["left_heel", "left_toe", "right_heel", "right_toe"]
    assert contacts.any(axis=0).all() and not contacts.all()
    assert retarget.to_robot(walk, g1, method="gmr").contacts is None


def test_clip_arrays(walk: retarget.Clip) -> None:
    frames, joints = len(walk), len(walk.joint_names)
    assert walk.positions.shape == (frames, joints, 3)
    assert walk.rotations.shape == walk.local_rotations_xyzw.shape == (frames, joints, 4)
    np.testing.assert_allclose(np.linalg.norm(walk.rotations, axis=2), 1.0, atol=1e-12)
    np.testing.assert_array_equal(walk.rotations_wxyz[..., [1, 2, 3, 0]], walk.rotations_xyzw)
    np.testing.assert_array_equal(walk.local_rotations_wxyz[..., [1, 2, 3, 0]],
                                  walk.local_rotations_xyzw)
    # An independent conversion from local to world.
    for joint, parent in enumerate(walk.parents):
        if parent < 0:
            np.testing.assert_array_equal(walk.positions[:, joint], walk.local_positions[:, joint])
            continue
        w, v = walk.rotations[:, parent, :1], walk.rotations[:, parent, 1:]
        p = walk.local_positions[:, joint]
        turned = p + 2 * np.cross(v, np.cross(v, p) + w * p)
        np.testing.assert_allclose(walk.positions[:, joint], walk.positions[:, parent] + turned,
                                   atol=1e-9)


def test_nothing_is_copied_and_memory_stays(walk: retarget.Clip, walked: retarget.Motion,
                                            data: Path) -> None:
    assert np.shares_memory(walked.qpos, walked.joint_positions)
    assert np.shares_memory(walked.qpos, walked.root_position)
    assert np.shares_memory(walk.positions, walk.positions)
    clip = retarget.load(data / "wave.bvh")
    local, positions = clip.local_rotations_xyzw, clip.positions
    qpos = retarget.to_robot(clip, "unitree_g1", method="gmr").qpos
    before = local.sum(), positions.sum(), qpos.sum()
    del clip
    gc.collect()
    junk = [np.full(100_000, 7.0) for _ in range(50)]
    assert (local.sum(), positions.sum(), qpos.sum()) == before
    del junk


@pytest.mark.parametrize("name", ["qpos", "root_position", "root_rotation_wxyz",
                                  "root_rotation_xyzw", "joint_positions", "contacts"])
def test_motions_cannot_be_written_to(name: str, walked: retarget.Motion) -> None:
    with pytest.raises(ValueError, match="read-only"):
        getattr(walked, name)[0] = 0


def test_forward_kinematics(walked: retarget.Motion, g1: retarget.Robot) -> None:
    positions, rotations = g1.forward_kinematics(walked.qpos[7])
    assert positions.shape == (len(g1.body_names), 3) and rotations.shape[1] == 4
    root = g1.body_names.index("pelvis")
    np.testing.assert_allclose(positions[root], walked.root_position[7])
    np.testing.assert_allclose(rotations[root], walked.root_rotation_wxyz[7], atol=1e-12)
    # The robot stands, so the sole bodies are lowest.
    assert positions[1:, 2].min() < 0.2 < positions[root][2]


def test_tracking_arrays_are_those_of_the_file(walked: retarget.Motion, tmp_path: Path) -> None:
    walked.save(tmp_path / "walk.npz", format="npz-beyondmimic", npz_fps=40)
    arrays = walked.tracking(format="npz-beyondmimic", npz_fps=40)
    with np.load(tmp_path / "walk.npz") as file:
        for name in ("joint_pos", "joint_vel", "body_pos_w", "body_quat_w", "body_lin_vel_w",
                     "body_ang_vel_w"):
            np.testing.assert_array_equal(arrays[name].astype(np.float32), file[name], name)
        assert arrays["fps"] == 40.0 == file["fps"][0]


def test_reference_arrays_are_those_of_the_file(walked: retarget.Motion, tmp_path: Path) -> None:
    walked.save(tmp_path / "walk.csv", reference_rate=125)
    arrays = walked.reference(125)
    with np.load(tmp_path / "walk.reference.npz") as file:
        for name in file.files:
            np.testing.assert_array_equal(np.asarray(arrays[name]).ravel(), file[name].ravel(),
                                          name)
        assert set(arrays) == {*file.files, "notes"}
    assert arrays["qvel"].shape == (len(arrays["time"]), 35)
    steps = np.diff(arrays["qpos"][:, 7:], axis=0) * 125
    middle = 0.5 * (arrays["qvel"][1:, 6:] + arrays["qvel"][:-1, 6:])
    assert np.abs(steps - middle).max() < 0.05
    with pytest.raises(retarget.UsageError, match="from 10 to 1000"):
        walked.reference(5)


def test_motions_are_read_again(walked: retarget.Motion, g1: retarget.Robot,
                                tmp_path: Path) -> None:
    for ending in ("csv", "npz", "pkl"):
        file = tmp_path / f"walk.{ending}"
        walked.save(file, **({} if ending == "csv" else
                             {"format": "npz-mjlab" if ending == "npz" else "pkl-gmr"}))
        motion = retarget.load_motion(file, g1)
        assert motion.joint_names == walked.joint_names
        if ending == "npz":
            assert motion.fps == 50.0
        else:
            np.testing.assert_allclose(motion.qpos, walked.qpos, atol=1e-6)
        assert motion.source is None
        if ending == "npz":  # An NPZ stores them, at its own rate.
            assert motion.contacts.shape == (len(motion), 4)
            nearest = np.minimum(np.rint(np.arange(len(motion)) * 0.6).astype(int), len(walked) - 1)
            assert (motion.contacts == walked.contacts[nearest]).mean() > 0.99
        else:
            assert motion.contacts is None


def test_batched_kinematics(walked: retarget.Motion, g1: retarget.Robot) -> None:
    bodies = len(g1.body_names)
    positions, rotations = g1.forward_kinematics(walked.qpos[:20])
    assert positions.shape == (20, bodies, 3) and rotations.shape == (20, bodies, 4)
    for frame in range(20):
        one = g1.forward_kinematics(walked.qpos[frame])
        np.testing.assert_array_equal(positions[frame], one[0])
        np.testing.assert_array_equal(rotations[frame], one[1])
    empty = g1.forward_kinematics(walked.qpos[:0])
    assert empty[0].shape == (0, bodies, 3) and empty[1].shape == (0, bodies, 4)
    wrong = walked.qpos[:5].copy()
    wrong[3, 3:7] = 0.0
    with pytest.raises(retarget.UsageError, match=r"qpos\[3, 3:7\]: expected a quaternion"):
        g1.forward_kinematics(wrong)
    with pytest.raises(retarget.UsageError, match=r"expected shape \(n, 36\), found \(5, 35\)"):
        g1.forward_kinematics(walked.qpos[:5, 1:])
    for shape in ((2, 3, 36), (36, 1), ()):
        with pytest.raises(retarget.UsageError, match="expected shape"):
            g1.forward_kinematics(np.ones(shape))


def test_kinematics_are_mujoco_s(walked: retarget.Motion, g1: retarget.Robot) -> None:
    mujoco = pytest.importorskip("mujoco")
    try:
        model = mujoco.MjModel.from_xml_path(g1.model)
    except ValueError as error:  # Older versions reject bodies without mass.
        pytest.skip(str(error))
    data = mujoco.MjData(model)
    positions, rotations = g1.forward_kinematics(walked.qpos[::20])
    assert [model.body(i).name for i in range(model.nbody)] == g1.body_names
    for frame, qpos in enumerate(walked.qpos[::20]):
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        np.testing.assert_allclose(positions[frame], data.xpos, atol=1e-9)
        sign = np.sign((rotations[frame] * data.xquat).sum(axis=1, keepdims=True))
        np.testing.assert_allclose(sign * rotations[frame], data.xquat, atol=1e-9)
