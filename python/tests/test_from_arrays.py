"""Clips from arrays: the same motion as from a file, and clear errors for invalid motions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import retarget


def arrays_of(clip: retarget.Clip, space: str) -> dict[str, Any]:
    if space == "local":
        return {"positions": clip.local_positions, "rotations_wxyz": clip.local_rotations_wxyz,
                "space": "local"}
    return {"positions": clip.positions, "rotations_xyzw": clip.rotations_xyzw}


@pytest.mark.parametrize("space", ["world", "local"])
@pytest.mark.parametrize("method", ["fit", "gmr"])
def test_the_motion_is_that_of_the_file(space: str, method: str, data, g1) -> None:
    for name in ("walk", "get_up"):
        clip = retarget.load(data / f"{name}.bvh")
        made = retarget.Clip.from_arrays(clip.joint_names, clip.parents, fps=clip.fps, name=name,
                                         **arrays_of(clip, space))
        np.testing.assert_allclose(made.positions, clip.positions, atol=1e-9)
        np.testing.assert_allclose(made.offsets[1:], clip.offsets[1:], atol=1e-9)
        motion = retarget.to_robot(made, g1, method=method)
        expected = retarget.to_robot(clip, g1, method=method)
        np.testing.assert_allclose(motion.qpos, expected.qpos, atol=1e-6)


def test_float32_lists_and_slices(walk: retarget.Clip) -> None:
    def make(convert) -> retarget.Clip:
        return retarget.Clip.from_arrays(walk.joint_names, np.array(walk.parents),
                                         convert(walk.positions),
                                         rotations_wxyz=convert(walk.rotations), fps=walk.fps)

    masked = np.ma.masked_greater(walk.positions, 0.5)
    with pytest.raises(retarget.UsageError, match="masked"):
        make(lambda array: masked if array.shape == masked.shape else array)
    exact = make(np.array)
    assert make(lambda array: array.tolist()).positions.tobytes() == exact.positions.tobytes()
    assert make(np.asfortranarray).positions.tobytes() == exact.positions.tobytes()
    wide = make(lambda array: np.repeat(array, 2, axis=2)[..., ::2])
    assert wide.positions.tobytes() == exact.positions.tobytes()
    rough = make(lambda array: array.astype(np.float32))
    np.testing.assert_allclose(rough.positions, exact.positions, atol=1e-3)
    # Single-precision noise must not stretch joints.
    rough.save("/dev/null")
    assert (np.ptp(rough.local_positions[:, 1:], axis=0) == 0).all()


def test_any_order_of_joints(walk: retarget.Clip) -> None:
    order = np.random.default_rng(1).permutation(len(walk.parents))
    place = np.argsort(order)
    names = [walk.joint_names[old] for old in order]
    parents = [-1 if walk.parents[old] < 0 else place[walk.parents[old]] for old in order]
    made = retarget.Clip.from_arrays(names, parents, walk.positions[:, order],
                                     rotations_wxyz=walk.rotations[:, order], fps=30)
    back = [made.joint_names.index(name) for name in walk.joint_names]
    np.testing.assert_allclose(made.positions[:, back], walk.positions, atol=1e-9)


def test_a_joint_that_moves_on_its_parent() -> None:
    positions = np.zeros((5, 2, 3))
    positions[:, 1, 0] = np.linspace(1.0, 2.0, 5)
    rotations = np.tile([1.0, 0, 0, 0], (5, 2, 1))
    clip = retarget.Clip.from_arrays(["a", "b"], [None, 0], positions, rotations_wxyz=rotations,
                                     fps=10)
    np.testing.assert_array_equal(clip.positions, positions)
    assert clip.duration == pytest.approx(0.4)


GOOD: dict[str, Any] = {
    "names": ["a", "b"], "parents": [-1, 0], "positions": np.zeros((3, 2, 3)),
    "rotations_wxyz": np.tile([1.0, 0, 0, 0], (3, 2, 1)), "fps": 30.0}


@pytest.mark.parametrize(("change", "text"), [
    ({"positions": np.zeros((3, 2))}, r"positions: expected shape \(n, 2, 3\), found \(3, 2\)"),
    ({"positions": np.zeros((3, 3, 3))}, r"expected shape \(n, 2, 3\), found \(3, 3, 3\)"),
    ({"positions": [[[0, 0, 0], [0, 0]]]}, "positions: expected an array of shape"),
    ({"positions": "text"}, "positions: expected an array of numbers, found dtype <U4"),
    ({"positions": None}, "positions: expected an array of numbers, found dtype object"),
    ({"positions": np.zeros((3, 2, 3), complex)}, "found dtype complex128"),
    ({"positions": np.zeros((3, 2, 3), bool)}, "found dtype bool"),
    ({"positions": np.full((3, 2, 3), np.nan)}, r"positions\[0, 0, 0\]: expected a finite number"),
    ({"rotations_wxyz": np.zeros((2, 2, 4))}, r"rotations_wxyz: expected shape \(3, 2, 4\)"),
    ({"rotations_wxyz": np.zeros((3, 2, 4))}, "expected unit quaternions, found one of length 0"),
    ({"rotations_wxyz": np.full((3, 2, 4), np.inf)}, r"rotations_wxyz\[0, 0, 0\]"),
    ({"rotations_wxyz": None}, "Clip.from_positions takes positions alone"),
    ({"rotations_xyzw": np.zeros((3, 2, 4))}, "both given"),
    ({"parents": [0, 0]}, "found a cycle"),
    ({"parents": [-1, -1]}, 'two roots, "a" and "b"'),
    ({"parents": [-1, 2]}, r"parents\[1\]: expected -1 to 1, found 2"),
    ({"parents": [1, 0]}, "found a cycle"),
    ({"parents": [-1]}, "parents: expected 2 of them"),
    ({"parents": ["a", "b"]}, "parents: expected whole numbers"),
    ({"names": ["a", "a"]}, '"a" is given twice'),
    ({"names": ["a", ""]}, "a joint has no name"),
    ({"names": "ab"}, "names: expected a sequence of strings"),
    ({"fps": 0.0}, "fps: expected frames per second"),
    ({"fps": float("nan")}, "fps: expected frames per second"),
    ({"space": "global"}, 'space: expected "world" or "local"'),
    ({"names": [], "parents": [], "positions": np.zeros((0, 0, 3)),
      "rotations_wxyz": np.zeros((0, 0, 4))}, "names: expected at least one joint"),
])
def test_invalid_motions(change: dict[str, Any], text: str) -> None:
    with pytest.raises(retarget.UsageError, match=text):
        retarget.Clip.from_arrays(**{**GOOD, **change})


def test_a_clip_without_frames(g1: retarget.Robot) -> None:
    clip = retarget.Clip.from_arrays(["a", "b"], [-1, 0], np.zeros((0, 2, 3)),
                                     rotations_wxyz=np.zeros((0, 2, 4)), fps=30)
    assert clip.positions.shape == clip.local_positions.shape == (0, 2, 3)
    assert clip.local_rotations_xyzw.shape == (0, 2, 4)
    with pytest.raises(retarget.InputError, match="no frames"):
        retarget.to_robot(clip, g1)
    with pytest.raises(retarget.Error):
        retarget.edit.mirror(clip)


def test_non_human_bodies(g1: retarget.Robot) -> None:
    clip = retarget.Clip.from_arrays(**GOOD)
    with pytest.raises(retarget.InputError) as raised:
        retarget.to_robot(clip, g1)
    assert raised.value.hint


def _one(**changes: Any) -> retarget.Clip:
    given = dict(names=["a", "b"], parents=[-1, 0], positions=np.zeros((1, 2, 3)),
                 rotations_wxyz=np.tile([1.0, 0.0, 0.0, 0.0], (1, 2, 1)), fps=30)
    return retarget.Clip.from_arrays(**(given | changes))


@pytest.mark.parametrize("changes", [
    {"names": ["a", "\ud800"]}, {"parents": [-1, 2**40]}, {"fps": None}, {"fps": "fast"},
    {"parents": np.array([[-1], [0]])}, {"parents": [-1, 0.0]}, {"name": b"a"},
    {"name": "\ud800"}, {"name": None}], ids=str)
def test_unknown_robots(changes: dict[str, Any]) -> None:
    with pytest.raises(retarget.UsageError):
        _one(**changes)


def test_names_round_trip() -> None:
    names = ["H\u00fcfte", "no utf-8 \udcff"]
    clip = _one(names=names)
    assert clip.joint_names == names
    again = retarget.Clip.from_arrays(clip.joint_names, clip.parents, clip.positions,
                                      rotations_wxyz=clip.rotations, fps=clip.fps)
    assert again.joint_names == names
