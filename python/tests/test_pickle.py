"""Pickles and copies: clips, robots, plans, motions and reports go to other processes unchanged."""

from __future__ import annotations

import copy
import pickle
import shutil
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest

import retarget

# Queues send the robot with every task.
ROBOT_PICKLE_BYTES = 4096


def again(value):
    return pickle.loads(pickle.dumps(value))


def saved(value, folder: Path, name: str, **options) -> bytes:
    value.save(folder / name, **options)
    return (folder / name).read_bytes()


def test_a_clip_comes_back(walk: retarget.Clip, tmp_path: Path) -> None:
    other = again(walk)
    assert saved(other, tmp_path, "a.bvh") == saved(walk, tmp_path, "b.bvh")
    assert other.name == walk.name and other.fps == walk.fps
    np.testing.assert_array_equal(other.positions, walk.positions)
    moved = retarget.edit.resample(walk, 23.976)
    assert again(moved).fps == moved.fps and repr(again(moved)) == repr(moved)


def test_warnings_of_a_clip_come_back(data: Path, tmp_path: Path) -> None:
    lines = (data / "walk.bvh").read_text().splitlines(keepends=True)
    (tmp_path / "cut.bvh").write_text("".join(lines[:-1]) + lines[-1][:20])
    with pytest.warns(retarget.RetargetWarning):
        clip = retarget.load(tmp_path / "cut.bvh", lenient=True)
    assert again(clip).warnings == clip.warnings != []


def test_a_robot_is_small_and_shared(g1: retarget.Robot) -> None:
    content = pickle.dumps(g1)
    assert len(content) < ROBOT_PICKLE_BYTES
    one, two = pickle.loads(content), pickle.loads(content)
    assert one.name == two.name == g1.name and one.joint_names == g1.joint_names
    np.testing.assert_array_equal(one.joint_limits(), g1.joint_limits())
    for dof in ("23", "27"):
        variant = retarget.Robot("g1", dof=dof)
        assert again(variant).variant == dof
        np.testing.assert_array_equal(again(variant).zero_configuration, variant.zero_configuration)


def own_model(g1: retarget.Robot, folder: Path) -> Path:
    shutil.copytree(Path(g1.model).parent, folder)
    return folder / "model.xml"


def test_a_robot_of_a_file(g1: retarget.Robot, tmp_path: Path,
                           monkeypatch: pytest.MonkeyPatch) -> None:
    model = own_model(g1, tmp_path / "own")
    monkeypatch.chdir(tmp_path)
    content = pickle.dumps(retarget.Robot("own/model.xml", robot_profile="own/robot.json"))
    # A worker's working directory may be another one.
    monkeypatch.chdir("/")
    assert pickle.loads(content).joint_names == g1.joint_names
    text = model.read_text()
    model.write_text(text + "<!-- another model -->\n")
    with pytest.raises(retarget.ConfigError, match="the model is not the one of the pickle"):
        pickle.loads(content)
    model.unlink()
    with pytest.raises(retarget.ConfigError, match="the robot of the pickle cannot be loaded"):
        pickle.loads(content)


def test_an_include_is_part_of_the_model(tmp_path: Path) -> None:
    (tmp_path / "limb.xml").write_text(
        '<mujocoinclude><body name="arm"><joint name="elbow" type="hinge" range="-1 1"/>'
        '<geom type="sphere" size="0.1" mass="1"/></body></mujocoinclude>')
    (tmp_path / "tiny.xml").write_text(
        '<mujoco><compiler angle="radian"/><worldbody><body name="base"><freejoint/>'
        '<geom type="sphere" size="0.1" mass="1"/><include file="limb.xml"/></body></worldbody>'
        "</mujoco>")
    with pytest.warns(retarget.RetargetWarning):
        content = pickle.dumps(retarget.Robot(tmp_path / "tiny.xml"))
    assert pickle.loads(content).joint_names == ["elbow"]
    limb = tmp_path / "limb.xml"
    limb.write_text(limb.read_text().replace("-1 1", "-2 2"))
    with pytest.raises(retarget.ConfigError, match="its content has changed"):
        pickle.loads(content)


OPTIONS = {
    "fit": {},
    "gmr": {"method": "gmr", "limits": "gmr", "fps": "source"},
    "tracking": {"for_": "tracking", "format": "npz-mjlab", "start": 0.5},
    "slower": {"time_scale": 0.8},
    "slowed": {"time_scale": "auto", "fit": {"max_joint_speed": 3.0}},
    "weights": {"fit": {"contact_weight": 500.0, "floor": False}, "without": ["speed"],
                "precision": 9},
}


@pytest.mark.parametrize("way", OPTIONS)
def test_a_motion_comes_back(way: str, walk: retarget.Clip, g1: retarget.Robot,
                             tmp_path: Path) -> None:
    motion = retarget.to_robot(walk, g1, **OPTIONS[way])
    other = again(motion)
    np.testing.assert_array_equal(other.qpos, motion.qpos)
    ending = "npz" if "format" in OPTIONS[way] else "csv"
    assert saved(other, tmp_path, f"walk.{ending}") == saved(motion, tmp_path, f"walk.{ending}")
    assert saved(other, tmp_path, "walk.glb", format="glb") == saved(motion, tmp_path, "walk.glb",
                                                                     format="glb")
    # All metrics, and the report of the fit.
    assert retarget.evaluate(other).json == retarget.evaluate(motion).json
    assert retarget.evaluate(other, limits="model").json == retarget.evaluate(
        motion, limits="model").json
    assert other.summary == motion.summary and repr(other) == repr(motion)
    np.testing.assert_array_equal(other.source.positions, motion.source.positions)
    if motion.contacts is not None:
        np.testing.assert_array_equal(other.contacts, motion.contacts)
    assert pickle.dumps(other) == pickle.dumps(motion)


def test_a_motion_of_a_file_comes_back(walked: retarget.Motion, g1: retarget.Robot,
                                       walk: retarget.Clip, tmp_path: Path) -> None:
    walked.save(tmp_path / "walk.npz", format="npz-mjlab")
    motion = retarget.load_motion(tmp_path / "walk.npz", g1)
    other = again(motion)
    assert other.summary == motion.summary and other.source is None
    np.testing.assert_array_equal(other.contacts, motion.contacts)
    assert retarget.evaluate(other, walk).json == retarget.evaluate(motion, walk).json


def test_a_motion_outlives_its_clip(data: Path, g1: retarget.Robot) -> None:
    motion = retarget.to_robot(data / "wave.bvh", g1, method="gmr", end=0.5)
    assert retarget.evaluate(again(motion)).json == retarget.evaluate(motion).json


def test_a_plan_comes_back(walk: retarget.Clip, g1: retarget.Robot) -> None:
    plan = retarget.make_plan(walk, g1, fps=50, start=0.5, fit={"contact_weight": 500.0})
    other = again(plan)
    assert other.summary == plan.summary and other.options == plan.options
    assert (other.fps, other.frame_count, other.part) == (50.0, plan.frame_count, plan.part)
    solved = retarget.solve(other)
    assert solved.qpos.tobytes() == retarget.solve(plan).qpos.tobytes()
    same = retarget.to_robot(walk, g1, fps=50, start=0.5, fit={"contact_weight": 500.0})
    assert solved.qpos.tobytes() == same.qpos.tobytes() and len(solved) == plan.frame_count


def test_a_changed_option_file_is_an_error(walk: retarget.Clip, g1: retarget.Robot,
                                           tmp_path: Path) -> None:
    weights = tmp_path / "fit.json"
    weights.write_text('{"contact_weight": 500.0}')
    content = pickle.dumps(retarget.make_plan(walk, g1, fit_config=weights))
    assert pickle.loads(content).fps == 30.0
    weights.write_text('{"contact_weight": 400.0}')
    with pytest.raises(retarget.ConfigError, match="has changed"):
        pickle.loads(content)
    weights.unlink()
    with pytest.raises(retarget.ConfigError, match="fit.json"):
        pickle.loads(content)


def test_reports_and_copies(walked: retarget.Motion, walk: retarget.Clip,
                            g1: retarget.Robot) -> None:
    report = retarget.evaluate(walked)
    other = again(report)
    assert other.json == report.json and str(other) == str(report)
    assert other.figures == report.figures and other.faults == report.faults
    assert copy.deepcopy(report).json == report.json
    plan = retarget.make_plan(walk, g1)
    # The values are immutable, so a copy needs no memory.
    for value in (walked, walk, g1, plan):
        assert copy.deepcopy(value) is value and copy.copy(value) is value
    assert copy.deepcopy([walk, {"motion": walked}])[1]["motion"] is walked


def test_a_damaged_pickle_is_an_error(walk: retarget.Clip, walked: retarget.Motion) -> None:
    for value in (walk, walked):
        state = value.__getstate__()
        kind = type(value)
        for wrong in (b"", state[:100], state[:-1], state + b"x", b"x" + state,
                      state[:40] + b"\xff" * 8 + state[48:]):
            with pytest.raises(retarget.Error):
                kind.__new__(kind).__setstate__(wrong)


@pytest.mark.filterwarnings("ignore:nanobind:RuntimeWarning")
def test_an_object_is_not_changed_by_a_state(walk: retarget.Clip, data: Path) -> None:
    state = retarget.load(data / "wave.bvh").__getstate__()
    before = walk.positions.sum()
    with pytest.raises((TypeError, RuntimeError)):
        walk.__setstate__(state)
    with pytest.raises(TypeError):
        retarget.Clip.__new__(retarget.Clip).__setstate__("text")
    assert walk.positions.sum() == before


def csv_of(plan: retarget.Plan) -> bytes:
    return retarget.solve(plan, threads=1).qpos.tobytes()


def motion_of(clip: retarget.Clip, robot: retarget.Robot) -> retarget.Motion:
    return retarget.to_robot(clip, robot, threads=1)


def test_processes_map_over_clips(data: Path, g1: retarget.Robot) -> None:
    clips = [retarget.load(data / f"{name}.bvh") for name in ("walk", "wave", "squat")]
    plans = [retarget.make_plan(clip, g1) for clip in clips]
    here = [csv_of(plan) for plan in plans]
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        assert list(pool.map(csv_of, plans)) == here
        motions = list(pool.map(motion_of, clips, [g1] * len(clips)))
    assert [motion.qpos.tobytes() for motion in motions] == here
    assert all(retarget.evaluate(motion).passed for motion in motions)
