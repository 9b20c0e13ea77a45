"""Robots' models in other readers: GMR's KinematicsModel and MimicKit's character reader take MJCF with ElementTree.

Neither compiles a model: they lack the values that MuJoCo adds by default, by a class or by a joint's offset, in
silence or with an exception. So every model of a robot states it. The rules are those of the two readers together.
"""

import json
import random
import unittest
import xml.etree.ElementTree as ElementTree

from optional_numpy import numpy as np
from tool import SOURCE, ToolTest, absent

UNREAD_ROTATIONS = ("euler", "axisangle", "xyaxes", "zaxis")


class NotReadable(Exception):
    """A model that a reader rejects, or reads differently from MuJoCo."""


def require(condition, what):
    if not condition:
        raise NotReadable(what)


def numbers(text, count, what):
    values = np.array([float(value) for value in text.split()])
    require(len(values) == count and np.isfinite(values).all(), f"{what}: {text}")
    return values


class Body:
    def __init__(self, element, parent):
        self.name, self.parent = element.get("name"), parent
        require(self.name, "a body without a name")
        for attribute in UNREAD_ROTATIONS:
            require(attribute not in element.attrib, f"{self.name}: only quat is read, not {attribute}")
        self.position = numbers(element.get("pos", "0 0 0"), 3, f"{self.name}: pos")
        self.rotation = numbers(element.get("quat", "1 0 0 0"), 4, f"{self.name}: quat")
        require(abs(np.linalg.norm(self.rotation) - 1) < 1e-5, f"{self.name}: quat is not of unit length")
        joints = element.findall("joint") if parent is not None else []
        # Several joints on one body would form a ball joint, for example.
        require(len(joints) <= 1, f"{self.name}: {len(joints)} joints on one body")
        self.joint = joints[0].get("name") if joints else None
        if joints:
            self.read_joint(joints[0])

    def read_joint(self, element):
        name = self.joint
        require(name, f"{self.name}: a joint without a name")
        require(element.get("type") == "hinge", f"{name}: type is not an explicit hinge")
        require("axis" in element.attrib, f"{name}: no axis")
        self.axis = numbers(element.get("axis"), 3, f"{name}: axis")
        require(abs(np.linalg.norm(self.axis) - 1) < 1e-5, f"{name}: axis is not of unit length")
        require("range" in element.attrib, f"{name}: no range")
        self.range = numbers(element.get("range"), 2, f"{name}: range")
        require(self.range[0] < self.range[1], f"{name}: range is empty")
        for offset, count in (("pos", 3), ("ref", 1)):
            values = numbers(element.get(offset, "0 " * count), count, f"{name}: {offset}")
            require(not values.any(), f"{name}: {offset} is not read")


class Character:
    """A model as read by the two readers."""

    def __init__(self, file):
        model = ElementTree.parse(file).getroot()
        require(model.find("compiler") is not None and model.find("compiler").get("angle") == "radian", "angle")
        require(next(model.iter("include"), None) is None, "include is not read")
        trees = model.find("worldbody").findall("body")
        require(len(trees) == 1, f"{len(trees)} bodies in the world; the first alone is read")
        self.bodies = []
        self.add(trees[0], None)
        names = [body.name for body in self.bodies]
        require(len(set(names)) == len(names), "a name of two bodies")

    def add(self, element, parent):
        self.bodies.append(Body(element, parent))
        index = len(self.bodies) - 1
        for child in element.findall("body"):
            self.add(child, index)

    def joints(self):
        return {body.joint: body for body in self.bodies if body.joint}

    def poses(self, root, joints):
        """World poses of all bodies (position, quaternion w x y z) by name, of a root pose and joint positions."""
        found = []
        for body in self.bodies:
            if body.parent is None:
                found.append(root)
                continue
            position, rotation = found[body.parent]
            position = position + rotate(rotation, body.position)
            rotation = product(rotation, body.rotation)
            if body.joint:
                half = joints[body.joint] / 2
                rotation = product(rotation, np.concatenate([[np.cos(half)], np.sin(half) * body.axis]))
            found.append((position, rotation))
        return {body.name: pose for body, pose in zip(self.bodies, found)}


def product(a, b):
    w, v = a[0] * b[0] - a[1:] @ b[1:], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.concatenate([[w], v])


def rotate(quaternion, vector):
    w, v = quaternion[0], quaternion[1:]
    return vector + 2 * np.cross(v, np.cross(v, vector) + w * vector)


def models():
    return sorted(SOURCE.glob("robots/**/*.xml"))


class ModelReaders(ToolTest):
    def setUp(self):
        super().setUp()
        if np is None:
            absent("this Python has no numpy")

    def characters(self):
        """Robots of the source tree with their models: name, options of the tool, file."""
        for file in models():
            variant = file.stem.removeprefix("model_") if file.stem != "model" else ""
            yield file.parent.name, (("--dof", variant) if variant else ()), file

    def assert_moves_alike(self, file, robot, options=(), frames=8):
        """Asserts that bodies match the tool, which compiles the model with MuJoCo."""
        character = Character(file)
        held = character.joints()
        shown = self.run_tool("robots", "show", robot, "--json")
        self.assert_done(shown)
        columns = [joint["name"] for joint in json.loads(shown.stdout)["joints"]]
        dice = random.Random(1)
        rows = []
        for frame in range(frames):
            # Joints that a variant lacks are at 0.
            turns = [dice.uniform(*held[joint].range) if joint in held else 0 for joint in columns]
            rows.append([0.1 * frame, -0.2, 0.9, 0, 0, 0, 1, *turns])
        self.write("pose.csv", "".join(",".join(f"{value:.9f}" for value in row) + "\n" for row in rows))
        self.assert_done(self.run_tool("convert", "pose.csv", "pose.npz", "--robot", robot, *options, "--source-fps",
                                       "50", "--fps", "50", "--source-quat", "xyzw", "--format", "npz-holosoma"))
        motion = np.load(self.folder / "pose.npz")
        joints = [str(name) for name in motion["joint_names"]]
        bodies = [str(name) for name in motion["body_names"]]
        self.assertLessEqual(set(bodies), {body.name for body in character.bodies})
        self.assertGreater(len(motion["joint_pos"]), frames // 2)
        for frame, values in enumerate(motion["joint_pos"].astype(float)):
            expected = character.poses((values[:3], values[3:7]), dict(zip(joints, values[7:])))
            for b, name in enumerate(bodies):
                position, rotation = expected[name]
                off = np.abs(motion["body_pos_w"][frame][b] - position).max()
                self.assertLess(off, 5e-6, f"{name} in frame {frame}")
                turned = 1 - abs(motion["body_quat_w"][frame][b] @ rotation)
                self.assertLess(turned, 1e-5, f"{name} in frame {frame}")

    def test_every_model_states_the_attributes_that_readers_need(self):
        self.assertGreater(len(models()), 20)
        for file in models():
            with self.subTest(model=str(file.relative_to(SOURCE))):
                try:
                    self.assertGreater(len(Character(file).joints()), 18)
                except NotReadable as error:
                    self.fail(str(error))

    def test_the_readers_move_every_robot_as_the_tool_does(self):
        for robot, options, file in self.characters():
            with self.subTest(robot=robot, options=options):
                self.assert_moves_alike(file, robot, options)

    def test_new_robots_are_readable(self):
        """Anchors, several joints of a body and joints without limits are written so that the readers take them."""
        text = (SOURCE / "robots/unverified/booster_k1/model.xml").read_text()
        # Both hips have joints on one body, knees off their bodies' origins, shoulders without
        # limits.
        for side, joint in (("Left", "ALeft"), ("Right", "ARight")):
            text = without_body(text, f"{side}_Hip_Roll")
            text = text.replace(f'<joint name="{side}_Knee_Pitch"', f'<joint name="{side}_Knee_Pitch" pos="0.01 0 -0.02"')
            text = without_range(text, f"{joint}_Shoulder_Pitch")
        model = self.write("odd.xml", text)
        with self.assertRaises(NotReadable):
            Character(model)
        self.assert_done(self.run_tool("robots", "add", "odd", "--model", "odd.xml"))
        try:
            self.assertEqual(len(Character(self.folder / "odd/model.xml").joints()), 22)
        except NotReadable as error:
            self.fail(str(error))
        self.assert_moves_alike(self.folder / "odd/model.xml", "odd")
        # Motion files have the bodies of the model.
        motion = np.load(self.folder / "pose.npz")
        names = {body.get("name") for body in ElementTree.parse(model).iter("body")}
        self.assertEqual(set(map(str, motion["body_names"])), names)


def without_range(text, joint):
    head, tail = text.split(f'<joint name="{joint}"', 1)
    attributes, tail = tail.split("/>", 1)
    kept = attributes.split(" range=")[0]
    return f'{head}<joint name="{joint}"{kept}/>{tail}'


def without_body(text, name):
    """Moves the joint of a body to the body below, which replaces it."""
    tree = ElementTree.ElementTree(ElementTree.fromstring(text))
    above = {child: parent for parent in tree.iter() for child in parent}
    body = next(body for body in tree.iter("body") if body.get("name") == name)
    below = body.find("body")
    offset = [float(value) for value in below.get("pos", "0 0 0").split()]
    joint = body.find("joint")
    joint.set("pos", " ".join(str(-value) for value in offset))
    below.insert(0, joint)
    place = [float(value) for value in body.get("pos", "0 0 0").split()]
    below.set("pos", " ".join(str(a + b) for a, b in zip(place, offset)))
    parent = above[body]
    parent.insert(list(parent).index(body), below)
    parent.remove(body)
    return ElementTree.tostring(tree.getroot(), encoding="unicode")


if __name__ == "__main__":
    unittest.main()
