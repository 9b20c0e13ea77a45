"""Clips from positions: joints are kept, robots move alike, invalid motions raise clear errors."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import retarget


def made(*arguments: Any, **keywords: Any) -> retarget.Clip:
    """from_positions without its warnings."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return retarget.Clip.from_positions(*arguments, **keywords)


def test_joints_stay(walk: retarget.Clip) -> None:
    clip = made(walk.positions, walk.joint_names, fps=walk.fps)
    back = [clip.joint_names.index(name) for name in walk.joint_names]
    np.testing.assert_allclose(clip.positions[:, back], walk.positions, atol=1e-3)  # Centimetres.
    assert any("rotations were computed" in text for text in clip.warnings)
    assert clip.fps == walk.fps and clip.name == "positions"


def test_a_robot_moves_alike(walk: retarget.Clip, g1: retarget.Robot) -> None:
    clip = made(walk.positions, walk.joint_names, fps=walk.fps)
    motion = retarget.to_robot(clip, g1)
    expected = retarget.to_robot(walk, g1)
    legs = [name for name in motion.joint_names if "knee" in name or "elbow" in name]
    columns = [motion.joint_names.index(name) for name in legs]
    off = np.abs(motion.joint_positions - expected.joint_positions)[:, columns]
    assert np.degrees(off.mean()) < 5.0


def test_any_array(walk: retarget.Clip) -> None:
    def make(positions: Any) -> bytes:
        return made(positions, walk.joint_names, fps=30).positions.tobytes()

    places = walk.positions.astype(np.float32)
    expected = make(places)
    assert make(places.tolist()) == expected
    assert make(np.asfortranarray(places)) == expected
    assert make(places.astype(">f4")) == expected
    assert make(np.repeat(places, 2, axis=0)[::2]) == expected


def test_known_orders_need_no_names(walk: retarget.Clip) -> None:
    assert made(walk.positions, fps=30).joint_names[0] == "Hips"
    with pytest.warns(retarget.RetargetWarning, match="the joint order of LAFAN1"):
        retarget.Clip.from_positions(walk.positions, fps=30)


@pytest.mark.parametrize("positions, names, keywords, text", [
    (np.zeros((5, 22, 3)), None, {}, "in the joint order of SMPL"),
    (np.zeros((5, 9, 3)), None, {}, "9 joints"),
    (np.zeros((5, 22)), None, {}, "positions"),
    (np.zeros((0, 22, 3)), None, {}, "positions"),
    (np.zeros((5, 3, 3)), ["a", "b"], {}, "positions"),
    (np.zeros((5, 2, 3)), ["a", "a"], {}, "two joints are called"),
    (np.zeros((5, 2, 3)), ["a", "b"], {}, "no human found in the joints"),
    (np.zeros((5, 2, 3)), "ab", {}, "names: expected a sequence of strings"),
    (np.zeros((5, 2, 3)), [], {}, "names: expected at least one joint"),
    (np.full((5, 22, 3), np.nan), None, {}, "positions"),
    (np.full((5, 22, 3), 1e12), None, {}, "out of range"),
    (None, None, {}, "positions"),
    ([["a"]], None, {}, "positions"),
    (np.zeros((5, 22, 3)), None, {"fps": 0}, "fps"),
    (np.zeros((5, 22, 3)), None, {"fps": "fast"}, "fps"),
    (np.zeros((5, 22, 3)), None, {"name": 3}, "name: expected a string"),
])
def test_invalid_motions(positions: Any, names: Any, keywords: dict[str, Any],
                           text: str) -> None:
    with pytest.raises(retarget.Error, match=text):
        retarget.Clip.from_positions(positions, names, **({"fps": 30} | keywords))
