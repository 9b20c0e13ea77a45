"""Scenes: bodies, distances, and the contacts of motions."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pytest

import retarget

HALF_TURN = [0.0, 0.0, 0.0, 1.0]  # about z, w x y z


@pytest.fixture(scope="module")
def scene_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("scene") / "room.json"
    file.write_text(json.dumps({"bodies": [
        {"name": "table", "position": [1, 2, 0], "quaternion": HALF_TURN,
         "shapes": [{"type": "box", "size": [1.2, 0.6, 0.1], "position": [0.5, 0, 0.7]}]},
        {"name": "ball", "moves": True, "mass": 4, "position": [5, 5, 1],
         "shapes": [{"type": "sphere", "radius": 0.25}]},
        {"name": "wedge", "position": [-6, 0, 0], "shapes": [
            {"type": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
             "triangles": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]}]}]}))
    return file


def test_bodies(scene_file: Path) -> None:
    scene = retarget.load_scene(scene_file)
    assert scene.body_names == ["table", "ball", "wedge"] and len(scene) == 3
    assert scene.frame_count == 1 and scene.fps is None and "3 bodies" in repr(scene)
    table, ball, wedge = scene.bodies
    assert (table.name, table.moves, ball.moves, ball.mass) == ("table", False, True, 4.0)
    [box] = table.shapes
    assert box.type == "box" and box.half_size.tolist() == [0.6, 0.3, 0.05]
    assert box.position.tolist() == [0.5, 0.0, 0.7] and box.rotation_wxyz.tolist() == [1, 0, 0, 0]
    assert ball.shapes[0].type == "sphere" and ball.shapes[0].radius == 0.25
    mesh = wedge.shapes[0]
    assert mesh.type == "mesh" and mesh.vertices.shape == (4, 3)
    assert mesh.triangles.shape == (4, 3) and mesh.triangles.dtype == np.int64
    np.testing.assert_array_equal(scene.positions, [[[1, 2, 0], [5, 5, 1], [-6, 0, 0]]])
    np.testing.assert_array_equal(scene.rotations_wxyz[0, 0], HALF_TURN)


def test_distances_are_exact(scene_file: Path) -> None:
    scene = retarget.load_scene(scene_file)
    # The box of the turned table is centred at (0.5, 2, 0.7).
    points = np.array([[0.5, 2, 1.0], [0.5, 2, 0.74], [1.3, 2, 0.7], [0.5, 2.4, 0.7], [1.4, 2.7, 0.7]])
    np.testing.assert_allclose(scene.distance("table", points), [0.25, -0.01, 0.2, 0.1, 0.5],
                               atol=1e-12)
    distances, normals = scene.distance_and_normal(0, points)
    np.testing.assert_array_equal(distances, scene.distance("table", points))
    np.testing.assert_allclose(normals[[0, 2, 3]], [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-12)
    rng = np.random.default_rng(1)
    around = rng.normal(scale=2.0, size=(500, 3)) + [5, 5, 1]
    np.testing.assert_allclose(scene.distance("ball", around),
                               np.linalg.norm(around - [5, 5, 1], axis=1) - 0.25, atol=1e-12)
    assert scene.distance("wedge", [[-5.8, 0.2, 0.2]])[0] < 0 < scene.distance("wedge", [[-6, 0, 2]])[0]
    assert scene.distance("ball", np.empty((0, 3))).shape == (0,)


def test_wrong_calls(scene_file: Path, tmp_path: Path) -> None:
    scene = retarget.load_scene(scene_file)
    for text, call in {
        'no body "tabel".*did you mean "table"': lambda: scene.distance("tabel", [[0, 0, 0]]),
        r"points: expected shape \(n, 3\)": lambda: scene.distance("table", [0, 0, 0]),
        "frame: expected 0 to 0, found 3": lambda: scene.distance("table", [[0, 0, 0]], frame=3),
        "body: expected 0 to 2": lambda: scene.distance(7, [[0, 0, 0]]),
        "points.*finite": lambda: scene.distance(0, [[np.nan, 0, 0]]),
    }.items():
        with pytest.raises(retarget.UsageError, match=text):
            call()
    with pytest.raises(retarget.InputError) as raised:
        retarget.load_scene(tmp_path / "none.json")
    assert isinstance(raised.value, FileNotFoundError)
    (tmp_path / "bad.json").write_text('{"bodies": [{"shapes": [{"type": "sphere"}]}]}')
    with pytest.raises(retarget.InputError, match="radius"):
        retarget.load_scene(tmp_path / "bad.json")


@pytest.fixture(scope="module")
def on_a_platform(walk: retarget.Clip, g1: retarget.Robot,
                  tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, retarget.Motion]:
    """The human walks on a platform whose top is the ground, and a ball moves past."""
    folder = tmp_path_factory.mktemp("platform")
    scene = folder / "platform.json"
    scene.write_text(json.dumps({"bodies": [
        {"name": "platform", "position": [0, 0, 0.005],
         "shapes": [{"type": "box", "size": [40, 40, 0.01]}]},
        {"name": "ball", "moves": True, "position": [3, 3, 1],
         "shapes": [{"type": "sphere", "radius": 0.2}]}]}))
    track = np.zeros((len(walk), 7))
    track[:, :3] = [3, 3, 1]
    track[:, 0] += np.linspace(0, 1, len(walk))
    track[:, 3] = 1.0
    np.save(folder / "ball.npy", track)
    motion = retarget.to_robot(walk, g1, scene=scene, object_track=f"ball={folder / 'ball.npy'}")
    return scene, motion


def test_a_motion_has_its_scene(on_a_platform: tuple[Path, retarget.Motion],
                                walked: retarget.Motion) -> None:
    _, motion = on_a_platform
    scene = motion.scene
    assert scene.body_names == ["platform", "ball"] and scene.fps == motion.fps
    assert scene.frame_count == len(motion) and scene.positions.shape == (len(motion), 2, 3)
    # Static bodies and paths have the robot's size, objects keep theirs.
    ball = scene.positions[:, 1]
    scale = ball[0, 0] / 3.0
    assert 0.5 < scale < 1.0 and ball[-1, 0] == pytest.approx(4.0 * scale)
    assert scene.bodies[1].shapes[0].radius == 0.2
    np.testing.assert_allclose(scene.distance("ball", ball[[-1]], frame=len(motion) - 1), -0.2,
                               atol=1e-12)
    assert scene.distance("ball", ball[[0]], frame=len(motion) - 1)[0] > 0.2
    assert walked.scene is None
    assert motion[5:].scene is None


def test_contact_labels(on_a_platform: tuple[Path, retarget.Motion], walked: retarget.Motion) -> None:
    _, motion = on_a_platform
    labels = motion.contact_labels
    assert labels.touching.shape == labels.sliding.shape == (len(motion), len(labels))
    assert labels.touching.any(axis=0).all()
    assert not (labels.sliding & ~labels.touching).any()
    assert set(labels.surfaces) <= {"platform", "floor"} and "platform" in labels.surfaces
    assert set(labels.links) <= set(motion.robot.body_names)
    # The feet's columns are those of Motion.contacts.
    for i, name in enumerate(motion.contact_names):
        columns = [c for c, part in enumerate(labels.parts) if part == name]
        np.testing.assert_array_equal(labels.touching[:, columns].any(axis=1), motion.contacts[:, i])
    intervals = labels.data["contacts"]
    assert labels.data["frames"] == len(motion)
    total = sum(each["last"] - each["first"] + 1 for each in intervals)
    assert total == labels.touching.sum()
    assert "platform" in str(labels)
    assert set(walked.contact_labels.surfaces) == {"floor"}


def test_contact_labels_are_the_command_s(on_a_platform: tuple[Path, retarget.Motion], data: Path,
                                          tmp_path: Path, command) -> None:
    scene, motion = on_a_platform
    command("contacts", data / "walk.bvh", "--robot", "g1", "--scene", scene, "--object-track",
            f"ball={scene.parent / 'ball.npy'}", "--json", tmp_path / "contacts.json")
    assert motion.contact_labels.json == (tmp_path / "contacts.json").read_text()


def test_without_a_fit_there_are_no_labels(walk: retarget.Clip, g1: retarget.Robot) -> None:
    motion = retarget.to_robot(walk, g1, method="gmr", end=0.2)
    assert motion.contact_labels is None and motion.scene is None


def test_a_motion_with_a_scene_comes_back(on_a_platform: tuple[Path, retarget.Motion],
                                          tmp_path: Path) -> None:
    scene, motion = on_a_platform
    content = pickle.dumps(motion)
    other = pickle.loads(content)
    assert other.qpos.tobytes() == motion.qpos.tobytes()
    np.testing.assert_array_equal(other.scene.positions, motion.scene.positions)
    assert other.contact_labels.json == motion.contact_labels.json
    assert retarget.evaluate(other).json == retarget.evaluate(motion).json
    for each, name in ((motion, "a.npz"), (other, "b.npz")):
        each.save(tmp_path / name, format="npz-mjlab")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    plan = retarget.make_plan(motion.source, motion.robot, scene=scene)
    assert plan.scene.body_names == ["platform", "ball"]
    assert pickle.loads(pickle.dumps(plan)).scene.body_names == plan.scene.body_names
    assert retarget.make_plan(motion.source, motion.robot).scene is None
