"""Body positions of pages: their script, in Node, against the kinematics of the models."""

import base64
import json
import re
import unittest
import xml.etree.ElementTree as xml
import zlib

import numpy as np

from pages import data_of
from tool import NODE, SOURCE, ToolTest, run_in_node

FRAMES = 7
# For all positions; joints are rounded to 5e-5 rad.
TOLERANCE = 2e-4

# A slide and a hinge with reference positions, and a hinge whose axis does not pass its body's
# origin.
MODEL = """
<mujoco><compiler angle="radian"/><worldbody><body name="base" pos="0 0 1"><freejoint/>
  <geom type="box" size="0.1 0.1 0.1"/>
  <body name="lift" pos="0 0 0.2" quat="0.5 0.5 0.5 0.5">
    <joint name="rise" type="slide" axis="0 0.6 0.8" range="-1 1" ref="0.15"/>
    <geom type="sphere" size="0.05"/>
    <body name="arm" pos="0.1 0.2 0">
      <joint name="turn" axis="0 1 0" pos="0.05 0 0.1" range="-2 2" ref="0.4"/>
      <geom type="sphere" size="0.05"/>
      <body name="hand" pos="0.3 0 0"><geom type="sphere" size="0.05"/></body>
</body></body></body></worldbody></mujoco>"""

PLACES = """
const { unpackTrack } = await import(`${viewer}/decode.js`);
const { Motion } = await import(`${viewer}/motions.js`);
const bytes = Buffer.from(value.tracks, 'base64');
let at = 0;
const tracks = value.header.tracks.map((track) => {
  const size = track.channels + 4 * track.channels * track.frames;
  at += size;
  return unpackTrack(bytes.subarray(at - size, at), track);
});
const motion = new Motion(value.header.motions[0], 0, value.header, tracks);
const places = Array.from({ length: motion.frames }, (_, frame) => {
  const poses = motion.bodyPoses(frame);
  return motion.robot.bodies.map(({ name }, i) => [name, [...poses.subarray(7 * i, 7 * i + 3)]]);
});
process.stdout.write(JSON.stringify(places));
"""


def matrix(quaternion):
    """A rotation, (3, 3), of a quaternion w x y z."""
    w, x, y, z = np.asarray(quaternion, float) / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def numbers(element, name, default):
    return np.array([float(each) for each in element.get(name, default).split()])


class Model:
    """An MJCF file in radians with one floating tree."""

    def __init__(self, text):
        root = xml.fromstring(text)
        self.axes = {
            each.get("class"): each.find("joint").get("axis")
            for each in root.iter("default")
            if each.get("class") and each.find("joint") is not None
        }
        [self.base] = root.find("worldbody").findall("body")
        self.joints = {
            joint.get("name"): joint
            for joint in self.base.iter("joint")
            if joint.get("type") != "free"
        }

    def places(self, position, quaternion, values):
        """Returns world positions of all bodies by name; joints without a value are at 0."""
        found = {}

        def visit(body, place, turn):
            found[body.get("name")] = place
            for child in body.findall("body"):
                at = place + turn @ numbers(child, "pos", "0 0 0")
                turned = turn @ matrix(numbers(child, "quat", "1 0 0 0"))
                for joint in child.findall("joint"):
                    axis = numbers(joint, "axis", self.axes.get(joint.get("class")) or "0 0 1")
                    axis = axis / np.linalg.norm(axis)
                    value = values.get(joint.get("name"), 0.0) - float(joint.get("ref", 0))
                    if joint.get("type") == "slide":
                        at = at + turned @ axis * value
                        continue
                    anchor = numbers(joint, "pos", "0 0 0")
                    spin = matrix([np.cos(value / 2), *(np.sin(value / 2) * axis)])
                    at = at + turned @ (anchor - spin @ anchor)
                    turned = turned @ spin
                visit(child, at, turned)

        visit(self.base, np.asarray(position), matrix(quaternion))
        return found


@unittest.skipUnless(NODE, "there is no Node")
class Positions(ToolTest):
    def shown(self, page):
        """Positions of a page's first motion: of each frame, by body."""
        tracks = re.search(r'id="page-tracks">(.*?)</script>', page, re.DOTALL)[1]
        unpacked = zlib.decompress(base64.b64decode(tracks))
        value = {"header": data_of(page)[0], "tracks": base64.b64encode(unpacked).decode()}
        script = (
            f"const viewer = {json.dumps((SOURCE / 'viewer/src').as_uri())};"
            f"const value = {json.dumps(value)};{PLACES}"
        )
        return [dict(frame) for frame in run_in_node(self, script)]

    def check(self, text, order, *options):
        """Compares a motion of all joints at arbitrary root poses."""
        model = Model(text)
        numbers_of = np.random.default_rng(5)
        low, high = np.array(
            [numbers(model.joints[name], "range", "-1 1") for name in order]
        ).T
        start, end = (low + (high - low) * numbers_of.random(len(order)) for _ in range(2))
        frames = []
        for share in np.linspace(0, 1, FRAMES):
            quaternion = np.array([0.8, 0.1 * share, -0.2, 0.5 * share])
            frames.append(
                (
                    np.array([1.0 + share, -2.0, 0.9 + 0.05 * share]).round(6),
                    (quaternion / np.linalg.norm(quaternion)).round(6),
                    (start + share * (end - start)).round(6),
                )
            )
        rows = [
            [*place, x, y, z, w, *joints] for place, (w, x, y, z), joints in frames
        ]
        self.write(
            "a.csv", "\n".join(",".join(f"{value:.6f}" for value in row) for row in rows) + "\n"
        )
        self.assert_done(
            self.run_tool(
                "view",
                "a.csv",
                *options,
                "--source-quat",
                "xyzw",
                "--source-unit",
                "m",
                "-o",
                "a.html",
            )
        )
        shown = self.shown((self.folder / "a.html").read_text())
        self.assertEqual(len(shown), FRAMES)
        for frame, (place, quaternion, joints) in zip(shown, frames):
            expected = model.places(place, quaternion, dict(zip(order, joints)))
            self.assertLessEqual(expected.keys(), frame.keys())
            for name, position in expected.items():
                self.assertLess(np.linalg.norm(position - frame[name]), TOLERANCE, name)

    def test_every_robot(self):
        folders = sorted(file.parent for file in SOURCE.glob("robots/*/robot.json"))
        self.assertGreater(len(folders), 5)
        for folder in folders:
            with self.subTest(folder.name):
                order = json.loads((folder / "robot.json").read_text())["joint_order"]
                self.check((folder / "model.xml").read_text(), order, "--robot", folder.name)

    def test_joints_that_are_held(self):
        folder = SOURCE / "robots/unitree_g1"
        robot = json.loads((folder / "robot.json").read_text())
        held = robot["variants"]["23"]["locked"]
        order = [name for name in robot["joint_order"] if name not in held]
        model = folder / robot["variants"]["23"]["model"]
        self.check(model.read_text(), order, "--robot", "unitree_g1", "--dof", "23")

    def test_slides_and_references(self):
        self.write("model.xml", MODEL)
        self.check(MODEL, ["rise", "turn"], "--robot-xml", "model.xml")


if __name__ == "__main__":
    unittest.main()
