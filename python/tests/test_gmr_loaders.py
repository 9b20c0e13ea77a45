"""Loaders and dictionaries that published scripts import."""

from __future__ import annotations

import pathlib
import pickle
import subprocess
import sys

import numpy as np
import pytest
from gmr_support import DATA, make_retargeter, sample_frames

import retarget
from retarget.gmr import load_robot_motion, params
from retarget.gmr.utils.lafan1 import load_bvh_file, load_lafan1_file
from retarget.gmr.utils.smpl import get_smplx_data, get_smplx_data_offline_fast, load_smplx_file


def test_lafan1_frames_are_metres_and_z_up() -> None:
    frames, height = load_bvh_file(DATA / "walk.bvh")
    clip = retarget.load(DATA / "walk.bvh")
    assert height == 1.75 and len(frames) == len(clip)
    assert set(frames[0]) == {*clip.joint_names, "LeftFootMod", "RightFootMod"}
    for frame in (0, 100):
        for i, name in enumerate(clip.joint_names):
            position, rotation = frames[frame][name]
            x, y, z = clip.positions[frame, i]
            np.testing.assert_allclose(position, np.array([x, -z, y]) / 100, rtol=0, atol=1e-15)
            # A vector of the joint, rotated both ways.
            np.testing.assert_allclose(
                _turn(rotation, [1.0, 2.0, 3.0]),
                _turn([np.sqrt(0.5), np.sqrt(0.5), 0, 0],
                      _turn(clip.rotations_wxyz[frame, i], [1.0, 2.0, 3.0])), atol=1e-12)
        for side in ("Left", "Right"):
            position, rotation = frames[frame][side + "FootMod"]
            np.testing.assert_array_equal(position, frames[frame][side + "Foot"][0])
            np.testing.assert_array_equal(rotation, frames[frame][side + "Toe"][1])
    assert frames[0]["Head"][0][2] > 1.2  # a standing human
    older, _ = load_lafan1_file(str(DATA / "walk.bvh"))
    np.testing.assert_array_equal(older[7]["Spine2"][1], frames[7]["Spine2"][1])


def _turn(wxyz, vector) -> np.ndarray:
    w, v = wxyz[0], np.asarray(wxyz[1:])
    return vector + 2.0 * np.cross(v, np.cross(v, vector) + w * np.asarray(vector))


def test_other_formats_are_named(tmp_path) -> None:
    with pytest.raises(ValueError, match="expected 'lafan1' or 'nokov'"):
        load_bvh_file(DATA / "walk.bvh", format="soma")
    with pytest.raises(ValueError, match="no joint LeftToeBase"):
        load_bvh_file(DATA / "walk.bvh", format="nokov")
    text = (DATA / "walk.bvh").read_text()
    nokov = tmp_path / "nokov.bvh"
    nokov.write_text(text.replace("LeftToe", "LeftToeBase").replace("RightToe", "RightToeBase"))
    frames, _ = load_bvh_file(nokov, format="nokov")
    np.testing.assert_array_equal(frames[3]["LeftFootMod"][1],
                                  sample_frames("walk", 4)[3]["LeftFootMod"][1])
    with pytest.raises(retarget.Error):
        load_bvh_file(tmp_path / "missing.bvh")


def _smplx_file(folder: pathlib.Path, fps: float = 120.0, frames: int = 61,
                turn: float = 0.02) -> pathlib.Path:
    poses = np.zeros((frames, 63))
    poses[:, 45] = np.linspace(0.0, turn * frames, frames)  # left_shoulder, about x
    upright = np.tile([np.pi / 2, 0.0, 0.0], (frames, 1))
    walked = np.linspace([0.0, 0.0, 0.9], [1.0, 0.0, 0.9], frames)
    file = folder / "motion.npz"
    np.savez(file, root_orient=upright, pose_body=poses, trans=walked, betas=np.full(16, 0.5),
             gender=np.array("neutral"), mocap_frame_rate=np.array(fps))
    return file


@pytest.mark.filterwarnings("ignore::retarget.RetargetWarning")
def test_smplx_files_become_frames_at_a_lower_rate(tmp_path) -> None:
    data, model, output, height = load_smplx_file(_smplx_file(tmp_path))
    assert height == pytest.approx(1.71) and model is None
    assert data["mocap_frame_rate"].item() == 120.0
    frames, fps = get_smplx_data_offline_fast(data, model, output, tgt_fps=30)
    # 61 frames in groups of four: 15 frames from the first to the last.
    assert len(frames) == 15 and fps == pytest.approx(15 / 61 * 120)
    assert len(frames[0]) == 22 and "left_foot" in frames[0]
    np.testing.assert_allclose(np.diff([frame["pelvis"][0][0] for frame in frames]), 1 / 14)
    elbows = [_turn(frame["left_shoulder"][1], [0.0, 1.0, 0.0]) for frame in frames]
    angles = np.unwrap([np.arctan2(y, z) for _, y, z in elbows])
    np.testing.assert_allclose(np.abs(np.diff(angles)), 0.02 * 61 / 14, rtol=1e-5)
    one = get_smplx_data(data, model, output, 30)
    np.testing.assert_array_equal(one["left_wrist"][0],
                                  output.positions[30, output.joint_names.index("left_wrist")])
    with pytest.raises(IndexError):
        get_smplx_data(data, model, output, 61)

    same, fps = get_smplx_data_offline_fast(data, model, output, tgt_fps=120)
    assert len(same) == 61 and fps == 120.0
    with pytest.raises(ValueError, match="load_smplx_file"):
        get_smplx_data_offline_fast(data, model, object())
    with pytest.raises(ValueError, match="hands are not read"):
        get_smplx_data_offline_fast(data, model, output, is_smplh=True)
    with pytest.raises(ValueError, match="tgt_fps"):
        get_smplx_data_offline_fast(data, model, output, tgt_fps=0)


def test_smplx_models_that_are_missing(tmp_path) -> None:
    file = _smplx_file(tmp_path)
    with pytest.raises(ValueError, match="no SMPLX_NEUTRAL.npz; without"):
        load_smplx_file(file, tmp_path)
    (tmp_path / "smplx").mkdir()
    (tmp_path / "smplx" / "SMPLX_NEUTRAL.pkl").touch()
    with pytest.raises(ValueError, match="docs/smpl.md"):
        load_smplx_file(file, tmp_path)
    (tmp_path / "text.npz").write_text("text")
    with pytest.raises(ValueError, match="text.npz"):
        load_smplx_file(tmp_path / "text.npz")


def test_motions_as_published_scripts_save_them(tmp_path) -> None:
    retargeter = make_retargeter()
    qpos = np.array([retargeter.retarget(frame) for frame in sample_frames("walk", 10)])
    motion = {"fps": 30, "root_pos": qpos[:, :3], "root_rot": qpos[:, [4, 5, 6, 3]],
              "dof_pos": qpos[:, 7:], "local_body_pos": None, "link_body_list": None}
    file = tmp_path / "motion.pkl"
    file.write_bytes(pickle.dumps(motion))
    read, fps, root_pos, root_rot, dof_pos, local, links = load_robot_motion(file)
    assert (fps, local, links) == (30, None, None) and set(read) == set(motion)
    np.testing.assert_array_equal(np.hstack([root_pos, root_rot, dof_pos]), qpos)

    for bad, expected in (({"fps": 30}, "root_rot"),
                          (motion | {"root_pos": "here"}, "root_pos"),
                          (motion | {"fps": "fast"}, "frame rate"),
                          ([1], "a dictionary")):
        file.write_bytes(pickle.dumps(bad))
        with pytest.raises(ValueError, match=expected):
            load_robot_motion(file)
    file.write_bytes(b"text")
    with pytest.raises(ValueError, match="not the pickle"):
        load_robot_motion(file)


def test_motions_of_ours_are_read(tmp_path) -> None:
    motion = retarget.to_robot(retarget.load(DATA / "wave.bvh"), "unitree_g1", method="gmr")
    motion.save(tmp_path / "motion.pkl", format="pkl-gmr")
    read, fps, root_pos, root_rot, dof_pos, local, links = load_robot_motion(tmp_path / "motion.pkl")
    assert fps == motion.fps and len(links) == local.shape[1]
    np.testing.assert_allclose(root_pos, motion.root_position, atol=1e-5)
    np.testing.assert_allclose(root_rot, motion.root_rotation_wxyz, atol=1e-5)
    np.testing.assert_allclose(dof_pos, motion.joint_positions, atol=1e-5)


@pytest.mark.parametrize("core", ["numpy.core", "numpy._core"])
def test_pickles_of_either_numpy(core: str, tmp_path) -> None:
    motion = {"fps": np.float64(30), "root_pos": np.zeros((2, 3)), "root_rot": np.zeros((2, 4)),
              "dof_pos": np.ones((2, 5))}
    written = pickle.dumps(motion, protocol=3)
    own = b"numpy._core" if b"numpy._core" in written else b"numpy.core"
    assert own in written
    file = tmp_path / "motion.pkl"
    file.write_bytes(written.replace(own, core.encode()))
    np.testing.assert_array_equal(load_robot_motion(file)[4], motion["dof_pos"])


def test_files_that_are_not_smplx(tmp_path) -> None:
    np.save(tmp_path / "array.npy", np.zeros(3))
    whole = _smplx_file(tmp_path).read_bytes()
    (tmp_path / "cut.npz").write_bytes(whole[:len(whole) // 2])
    damaged = bytearray(whole)
    for place in range(60, len(whole) // 2, 50):
        damaged[place] ^= 0xFF
    (tmp_path / "damaged.npz").write_bytes(damaged)
    packed = tmp_path / "packed.npz"
    np.savez_compressed(packed, poses=np.random.default_rng(1).normal(size=(30, 66)))
    content = bytearray(packed.read_bytes())
    content[200:400] = bytes(200)
    packed.write_bytes(content)
    (tmp_path / "folder.npz").mkdir()
    for name in ("array.npy", "cut.npz", "damaged.npz", "packed.npz", "folder.npz", "absent.npz"):
        with pytest.raises(retarget.InputError, match=name):
            load_smplx_file(tmp_path / name)


class _Runs:
    def __reduce__(self):
        return (print, ("it ran",))


def test_no_code_runs_from_a_motion(tmp_path, capsys) -> None:
    file = tmp_path / "motion.pkl"
    file.write_bytes(pickle.dumps({"root_pos": _Runs()}))
    with pytest.raises(ValueError, match="builtins.print"):
        load_robot_motion(file)
    assert capsys.readouterr().out == ""


def test_dictionaries_name_files_that_are_there() -> None:
    assert {"unitree_g1", "fourier_n1", "pal_talos"} <= set(params.ROBOT_XML_DICT)
    for model in params.ROBOT_XML_DICT.values():
        assert pathlib.Path(model).is_file()
    for configs in params.IK_CONFIG_DICT.values():
        for robot, config in configs.items():
            assert pathlib.Path(config).is_file()
            assert robot in params.ROBOT_BASE_DICT and robot in params.VIEWER_CAM_DISTANCE_DICT
    assert params.IK_CONFIG_DICT["bvh"] == params.IK_CONFIG_DICT["bvh_lafan1"]
    for name, base in params.ROBOT_BASE_DICT.items():
        if name in params.ROBOT_XML_DICT and "unverified" not in str(params.ROBOT_XML_DICT[name]):
            assert base in retarget.Robot(name).body_names
    assert params.ASSET_ROOT.is_dir() and params.IK_CONFIG_ROOT.is_dir()


def test_tables_of_the_published_package_are_found(tmp_path) -> None:
    package = tmp_path / "general_motion_retargeting"
    (package / "ik_configs").mkdir(parents=True)
    (package / "__init__.py").write_text("raise RuntimeError('imported')")
    (package / "ik_configs" / "smplx_to_g1.json").write_text("{}")
    robot = tmp_path / "assets" / "galaxea_r1pro"
    robot.mkdir(parents=True)
    (robot / "r1_pro.xml").write_text("<mujoco/>")
    code = ("from retarget.gmr.params import *\n"
            "print(IK_CONFIG_DICT['smplx']['unitree_g1'], ROBOT_XML_DICT['galaxea_r1pro'])")

    def found(**environment: str) -> str:
        import os
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                              env=os.environ | environment, timeout=120)
        return done.stdout + done.stderr

    expected = f"{package / 'ik_configs' / 'smplx_to_g1.json'} {robot / 'r1_pro.xml'}\n"
    assert found(RETARGET_GMR_ROOT=str(tmp_path)) == expected
    paths = [str(tmp_path), *sys.path]
    import os
    assert found(PYTHONPATH=os.pathsep.join(filter(None, paths))) == expected
    assert "no folder ik_configs" in found(RETARGET_GMR_ROOT=str(robot))


def test_published_imports_work() -> None:
    for module, names in {
        "retarget.gmr": ["GeneralMotionRetargeting", "RobotMotionViewer", "load_robot_motion",
                         "ROBOT_XML_DICT", "IK_CONFIG_DICT", "ROBOT_BASE_DICT",
                         "VIEWER_CAM_DISTANCE_DICT", "IK_CONFIG_ROOT", "ASSET_ROOT"],
        "retarget.gmr.motion_retarget": ["GeneralMotionRetargeting"],
        "retarget.gmr.params": ["ROBOT_XML_DICT", "IK_CONFIG_DICT"],
        "retarget.gmr.data_loader": ["load_robot_motion"],
        "retarget.gmr.robot_motion_viewer": ["RobotMotionViewer", "draw_frame"],
        "retarget.gmr.kinematics_model": ["KinematicsModel"],
        "retarget.gmr.utils.lafan1": ["load_lafan1_file", "load_bvh_file"],
        "retarget.gmr.utils.smpl": ["load_smplx_file", "get_smplx_data_offline_fast"],
    }.items():
        imported = __import__(module, fromlist=names)
        for name in names:
            assert hasattr(imported, name), f"{module}.{name}"
