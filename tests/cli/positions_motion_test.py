"""Joint positions without rotations: the robot moves as with the file that has both."""

import json
import re
import unittest

from joint_positions import PositionsTest, numpy
from tool import SHARED, needs_shared, sample

# Limbs of the G1 between the origins of its links.
SEGMENTS = [(f"{side}_{a}_link", f"{side}_{b}_link") for side in ("left", "right") for a, b in (
    ("hip_roll", "knee"), ("knee", "ankle_pitch"), ("shoulder_roll", "elbow"),
    ("elbow", "wrist_roll"))]


def segment_directions(path):
    """Unit vectors (F, S, 3) along SEGMENTS and the trunk, in the world, of a tracking NPZ."""
    motion = numpy.load(path)
    bodies = list(motion["body_names"])
    place = motion["body_pos_w"].astype(float)

    def at(name):
        return place[:, bodies.index(name)]

    lines = [at(b) - at(a) for a, b in SEGMENTS]
    lines.append(at("left_shoulder_pitch_link") + at("right_shoulder_pitch_link")
                 - at("left_hip_pitch_link") - at("right_hip_pitch_link"))
    lines = numpy.stack(lines, axis=1)
    return lines / numpy.linalg.norm(lines, axis=2, keepdims=True)


@unittest.skipIf(numpy is None, "needs numpy")
class PositionsMotion(PositionsTest):
    def solve(self, motion, name, *options):
        """Directions of the G1's limbs, the report's verdict, the messages."""
        result = self.run_tool(motion, "g1", "-o", f"{name}.npz", "--format", "npz-mjlab",
                               "--report", f"{name}.json", *options)
        self.assert_done(result)
        report = json.loads((self.folder / f"{name}.json").read_text())["motions"][0]
        return segment_directions(self.folder / f"{name}.npz"), report, result.stderr

    def assert_alike(self, found, expected, parts, degrees=3.0):
        cosine = numpy.clip((found * expected).sum(axis=2), -1, 1)
        angles = numpy.degrees(numpy.arccos(cosine)).mean(axis=0)[parts]
        self.assertLess(angles.max(), degrees, angles.round(2))

    def compare(self, motion, *options, parts=slice(None), gates=True):
        """A motion's own run against that of its places alone, with its names; some segments of it."""
        names, places = self.places_of(motion)
        numpy.savez(self.folder / "places.npz", joint_positions=places, joint_names=names, fps=30)
        truth, expected, _ = self.solve(motion, "truth", "--source-fps", 30, *options)
        found, report, said = self.solve("places.npz", "found", *options)
        self.assertIn("rotations were computed", said)
        self.assert_alike(found, truth, parts)
        if not gates:
            return
        verdicts = [{gate["metric"]: gate["passed"] for gate in one["gates"]}
                    for one in (report, expected)]
        self.assertEqual(*verdicts)

    def test_samples_without_their_rotations(self):
        for name in ("walk", "wave", "squat"):
            with self.subTest(name):
                self.compare(sample(name))

    def test_exchanged_sides_are_exchanged_back(self):
        other = {"Left": "Right", "Right": "Left"}
        for name in ("walk", "get_up"):
            names, places = self.places_of(sample(name))
            mirrored = [re.sub("^(Left|Right)", lambda side: other[side.group()], one) for one in names]
            backwards = places * [1, 1, -1]
            for file, one, at in (("right", names, places), ("names", mirrored, places),
                                  ("axes", names, backwards)):
                numpy.savez(self.folder / f"{file}.npz", joint_positions=at, joint_names=one, fps=30)
            truth, _, said = self.solve("right.npz", "truth")
            self.assertNotIn("exchange", said)
            for file, options in (("names", ()), ("axes", ("--mirror",))):
                with self.subTest(f"{name}: {file}"):
                    found, report, said = self.solve(f"{file}.npz", "found", *options)
                    self.assertIn("exchange left and right", said)
                    self.assertNotIn("swapped", said)
                    self.assert_alike(found, truth, slice(None), 0.5)
                    self.assertTrue(report["passed"])

    def test_legs_with_other_names_are_not_exchanged(self):
        names, places = self.places_of(sample("walk"))
        legs = [f"Right{one[4:]}" if re.match("Left.*(Leg|Foot|Toe)", one) else
                f"Left{one[5:]}" if re.match("Right.*(Leg|Foot|Toe)", one) else one for one in names]
        numpy.savez(self.folder / "legs.npz", joint_positions=places, joint_names=legs, fps=30)
        self.assertNotIn("exchange", self.run_tool("inspect", "legs.npz").stdout)

    def test_get_up_without_its_rotations(self):
        # A kneeling body bends its toes, which positions do not determine: only arms and trunk are
        # compared. The roll of hands on the floor, which decides the pose of planted arms, is
        # unknown as well.
        self.compare(sample("get_up"), "--without", "contact", parts=[2, 3, 6, 7, 8], gates=False)

    def test_frame_by_frame(self):
        self.compare(sample("walk"), "--method", "gmr", "--ik-config", "derived", "--scale", "limbs",
                     gates=False)

    @needs_shared
    def test_lafan1_without_its_rotations(self):
        self.compare(SHARED / "data/lafan1_cuts/fight1_subject2_backward.bvh")

    @needs_shared
    def test_smpl_without_its_rotations(self):
        self.compare(SHARED / "data/smpl/smpl_walk.npz")

    @needs_shared
    def test_climb_of_53_joints(self):
        climb = SHARED / "data/formats/climb_seq_0_joint_positions.npy"
        result = self.run_tool(climb, "g1", "-o", "climb.csv", "--report", "climb.json")
        self.assert_done(result)
        for words in ("120 fps, as holosoma's motions of 53 joints have", "optical motion capture",
                      "up +z", "unit m"):
            self.assertIn(words, result.stderr)
        report = json.loads((self.folder / "climb.json").read_text())["motions"][0]
        # Without its boxes, the robot stands on nothing, and a foot that stands on its toes at height
        # has no contact to keep.
        missed = {gate["metric"] for gate in report["gates"] if not gate["passed"]}
        self.assertIn("missing_surface_pct", missed)
        self.assertLessEqual(missed, {"hover_pct", "missing_surface_pct"})


if __name__ == "__main__":
    unittest.main()
