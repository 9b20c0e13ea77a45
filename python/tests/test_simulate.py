"""Motions replayed in physics."""

import numpy as np
import pytest

import retarget


@pytest.fixture(scope="module")
def squat(data):
    return retarget.to_robot(retarget.load(data / "squat.bvh"), "unitree_g1")


def test_squat_is_tracked(squat):
    done = retarget.simulate(squat)
    assert not done.fell
    assert done.motion.frame_count == squat.frame_count
    assert done.data["joint_error_deg"]["mean"] < 1.0
    assert np.abs(np.asarray(done.motion.qpos) - np.asarray(squat.qpos)).max() > 0.0
    assert "no fall" in repr(done)


def test_lifted_motion_falls(squat):
    qpos = np.array(squat.qpos)
    qpos[40:, 0] += 0.6
    moved = retarget.Motion.from_qpos(qpos, squat.robot, squat.fps)
    done = retarget.simulate(moved)
    assert done.fell and done.data["fall_reason"] in ("distance", "tilt", "height")


def test_short_motions_are_refused(squat):
    short = retarget.Motion.from_qpos(np.array(squat.qpos)[:2], squat.robot, squat.fps)
    with pytest.raises(retarget.InputError):
        retarget.simulate(short)
