"""Motions from arrays and parts of motions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import retarget


def test_from_qpos_keeps_every_bit(walked: retarget.Motion, g1: retarget.Robot,
                                   tmp_path: Path) -> None:
    motion = retarget.Motion.from_qpos(walked.qpos, g1, walked.fps, walked.contacts, name="walk")
    assert motion.qpos.tobytes() == walked.qpos.tobytes()
    np.testing.assert_array_equal(motion.contacts, walked.contacts)
    assert motion.fps == 30.0 and motion.source is None and motion.name == "walk"
    walked.save(tmp_path / "a.csv")
    motion.save(tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    walked.save(tmp_path / "a.npz", format="npz-mjlab")
    motion.save(tmp_path / "b.npz", format="npz-mjlab")
    with np.load(tmp_path / "a.npz") as a, np.load(tmp_path / "b.npz") as b:
        assert sorted(a) == sorted(b)
        for key in a:
            np.testing.assert_array_equal(a[key], b[key], key)


def test_from_qpos_takes_names_lists_and_narrow_numbers(walked: retarget.Motion) -> None:
    narrow = walked.qpos[:5].astype(np.float32)
    motion = retarget.Motion.from_qpos(narrow.tolist(), "unitree_g1", 50)
    np.testing.assert_allclose(motion.qpos, narrow, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(motion.root_rotation_wxyz, axis=1), 1.0, atol=1e-15)
    assert motion.contacts is None and motion.fps == 50.0
    assert motion.duration == pytest.approx(4 / 50)


def test_quaternions_become_continuous(walked: retarget.Motion, g1: retarget.Robot) -> None:
    flipped = walked.qpos.copy()
    flipped[1::2, 3:7] *= -1.0
    motion = retarget.Motion.from_qpos(flipped, g1, 30)
    np.testing.assert_array_equal(motion.qpos, walked.qpos)


def test_wrong_qpos(walked: retarget.Motion, g1: retarget.Robot) -> None:
    good = walked.qpos[:10]

    def changed(row: int, column: int, value: float) -> np.ndarray:
        copy = good.copy()
        copy[row, column] = value
        return copy

    make = retarget.Motion.from_qpos
    calls = {
        r"qpos: expected shape \(F, 36\): root x y z, root quaternion w x y z and the 29 joints of "
        r"unitree_g1 in the model's order; found \(10, 29\)": lambda: make(good[:, 7:], g1, 30),
        r"qpos: expected shape \(n, 36\), found \(36,\)": lambda: make(good[0], g1, 30),
        r"qpos\[4, 9\]: expected a finite number, found nan":
            lambda: make(changed(4, 9, np.nan), g1, 30),
        r"qpos\[5, 1\]: expected at most 1e6, found 1e\+39": lambda: make(changed(5, 1, 1e39), g1, 30),
        r"qpos\[2, 3:7\]: expected a unit quaternion w x y z, found the norm":
            lambda: make(changed(2, 3, 3.0), g1, 30),
        "qpos: expected at least one frame": lambda: make(good[:0], g1, 30),
        "qpos: expected an array": lambda: make([[1.0, 2.0], [3.0]], g1, 30),
        "fps: expected frames per second": lambda: make(good, g1, 0),
        "fps: expected frames per second, found None": lambda: make(good, g1, None),
        r"contacts: expected shape \(10, 4\), found \(9, 4\)":
            lambda: make(good, g1, 30, np.zeros((9, 4), bool)),
    }
    for text, call in calls.items():
        with pytest.raises(retarget.UsageError, match=text):
            call()


def test_a_variant_holds_its_joints(walk: retarget.Clip, g1: retarget.Robot) -> None:
    short = retarget.to_robot(walk, g1.name, dof="27", method="gmr", end=0.2)
    same = retarget.Motion.from_qpos(short.qpos, short.robot, short.fps)
    assert same.qpos.tobytes() == short.qpos.tobytes()
    wrong = short.qpos.copy()
    wrong[3, 7:] += 0.1
    with pytest.raises(retarget.UsageError, match=r"qpos\[3, \d+\]: \w+_joint is locked at"):
        retarget.Motion.from_qpos(wrong, short.robot, short.fps)


@pytest.mark.parametrize("part", [slice(10, 200), slice(-20, None), slice(None, -250),
                                  slice(5, 6), slice(None), slice(-1000, 9)])
def test_slices(part: slice, walked: retarget.Motion, g1: retarget.Robot) -> None:
    motion = walked[part]
    np.testing.assert_array_equal(motion.qpos, walked.qpos[part])
    np.testing.assert_array_equal(motion.contacts, walked.contacts[part])
    assert motion.fps == walked.fps and motion.robot.name == g1.name and motion.source is None
    assert motion.duration == pytest.approx((len(motion) - 1) / 30)


def test_a_part_of_a_part(walked: retarget.Motion) -> None:
    assert walked[10:100][5:].qpos.tobytes() == walked[15:100].qpos.tobytes()
    assert retarget.evaluate(walked[50:]).data["frames"] == len(walked) - 50


def test_the_summary_has_the_result_of_the_fit(walk: retarget.Clip, walked: retarget.Motion) -> None:
    labels = [line.split(" ")[0] for line in walked.summary.splitlines()]
    assert "robot" in labels and "floor" in labels
    fixed = retarget.to_robot(walk, "unitree_g1", base="fixed")
    assert "fit      fixed base: the fit has no foot" in fixed.summary


def test_the_summary_has_the_changed_timing(data: Path, g1: retarget.Robot) -> None:
    wave = retarget.load(data / "wave.bvh", source_fps=90)
    plan = retarget.make_plan(wave, g1, time_scale="auto", fit={"max_joint_speed": 4.0})
    assert "slowed" not in plan.summary
    for motion in (retarget.solve(plan), retarget.to_robot(wave, g1, time_scale="auto",
                                                   fit={"max_joint_speed": 4.0})):
        assert "s longer" in motion.summary


def test_slices_are_measured_at_their_time(walk: retarget.Clip, g1: retarget.Robot) -> None:
    motion = retarget.to_robot(walk, g1, start=1.0, fps=50)
    for part in (motion[50:250], motion[20:][30:230]):
        report = retarget.evaluate(part, walk)
        assert abs(report.data["lag_s"]) < 0.01
        assert report.passed
    slower = retarget.evaluate(motion[50:250].resample(30), walk)
    assert abs(slower.data["lag_s"]) < 0.01
    late = retarget.evaluate(motion[50:250], walk, start=1.6)
    assert abs(late.data["lag_s"]) > 0.3


def test_wrong_slices(walked: retarget.Motion) -> None:
    for step in (2, -1, 0):
        with pytest.raises((retarget.UsageError, ValueError), match="step") as raised:
            walked[::step]
    for step in (2, -1):
        with pytest.raises(retarget.UsageError, match=r"motion.resample\(fps\)"):
            walked[::step]
    for part in (slice(10, 10), slice(20, 10), slice(1000, None)):
        with pytest.raises(retarget.UsageError, match="no frames"):
            walked[part]
    for wrong in (3, "x", (1, 2)):
        with pytest.raises(TypeError, match="slice"):
            walked[wrong]
    with pytest.raises(TypeError):
        iter(walked).__next__()
    assert raised.value is not None


def test_resample(walked: retarget.Motion, walk: retarget.Clip) -> None:
    fast = walked.resample(60)
    assert fast.fps == 60 and len(fast) == 2 * len(walked) - 1
    np.testing.assert_array_equal(fast.qpos[::2], walked.qpos)
    np.testing.assert_array_equal(fast.contacts[::2], walked.contacts)
    assert walked.resample(30).qpos.tobytes() == walked.qpos.tobytes()
    assert retarget.evaluate(fast, walk).data["source_frames"] > 0
    with pytest.raises(retarget.UsageError, match="fps"):
        walked.resample(-1)


def test_options_of_the_output_stay(walk: retarget.Clip, g1: retarget.Robot,
                                    tmp_path: Path) -> None:
    motion = retarget.to_robot(walk, g1, method="gmr", precision=3, csv_header=True, end=0.2)
    motion[2:].save(tmp_path / "part.csv")
    lines = (tmp_path / "part.csv").read_text().splitlines()
    assert lines[0].startswith("root_x") and len(lines[1].split(",")[0].split(".")[1]) == 3


def test_formats_without_numbers_ignore_the_precision_of_the_motion(
        walk: retarget.Clip, g1: retarget.Robot, tmp_path: Path) -> None:
    motion = retarget.to_robot(walk, g1, method="gmr", precision=3, end=0.2)
    motion.save(tmp_path / "part.pkl", format="pkl-gmr")
    with pytest.raises(retarget.UsageError, match="precision"):
        motion.save(tmp_path / "part.pkl", format="pkl-gmr", precision=3)
    motion.save(tmp_path / "part.csv", format="csv,pkl-gmr")
    first = (tmp_path / "part.csv").read_text().splitlines()[0]
    assert len(first.split(",")[0].split(".")[1]) == 3


def test_to_dict(walked: retarget.Motion) -> None:
    every = walked.to_dict()
    assert every["robot"] == "unitree_g1" and every["fps"] == 30.0
    assert every["joint_names"] == walked.joint_names
    assert every["contact_names"] == walked.contact_names
    for name in ("qpos", "root_position", "root_rotation_wxyz", "joint_positions", "contacts"):
        np.testing.assert_array_equal(every[name], getattr(walked, name))


def test_contacts_of_an_npz_stay(walked: retarget.Motion, g1: retarget.Robot,
                                 tmp_path: Path) -> None:
    walked.save(tmp_path / "walk.npz", format="npz-mjlab")
    motion = retarget.load_motion(tmp_path / "walk.npz", g1)
    with np.load(tmp_path / "walk.npz") as file:
        np.testing.assert_array_equal(motion.contacts, file["contacts"])
    motion.save(tmp_path / "again.npz", format="npz-mjlab")
    with np.load(tmp_path / "again.npz") as file:
        np.testing.assert_array_equal(file["contacts"], motion.contacts[:len(file["contacts"])])
