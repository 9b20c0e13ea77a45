"""Bodies and files with parts missing, turned or in front: the motion is that of the whole one, or the run says why not."""

import json
import unittest

from tool import ToolTest, read_rows, sample

try:
    import numpy

    from bvh_twins import Bvh
except ImportError:
    numpy = None

POSITIONS = ["Xposition", "Yposition", "Zposition"]
TOES = ("LeftToe", "RightToe")
OTHER_NAMES = {"Hips": "pelvis", "Spine": "spine_a", "Spine1": "spine_b", "Spine2": "chest",
               "Neck": "neck", "Head": "head"}


def with_other_names(clip):
    """Returns joint names that no skeleton profile has."""
    parts = {"UpLeg": "thigh", "Leg": "shin", "Foot": "foot", "Toe": "toe", "Shoulder": "clavicle",
             "Arm": "upper_arm", "ForeArm": "forearm", "Hand": "hand"}
    for joint in clip.joints:
        for side in ("Left", "Right"):
            if joint.name.startswith(side):
                joint.name = f"{side.lower()}_{parts[joint.name[len(side):]]}"
        joint.name = OTHER_NAMES.get(joint.name, joint.name)
    return clip


@unittest.skipIf(numpy is None, "numpy is missing")
class OddBody(ToolTest):
    def run_clip(self, clip, *options, name="clip"):
        """The motion's rows, the messages, and how far the limbs are from the human's, degrees."""
        source = self.write(f"{name}.bvh", clip.text())
        report = self.folder / f"{name}.json"
        done = self.retarget("--report", report, *options, bvh=source, output=f"{name}.csv")
        self.assert_done(done)
        rows = numpy.array(read_rows((self.folder / f"{name}.csv").read_text()))
        self.assertTrue(numpy.isfinite(rows).all())
        return rows, done.stderr, json.loads(report.read_text())

    def limb_angle(self, motion, clip, *options):
        """Returns the limb angle of a motion against the positions of the whole clip."""
        source = self.write("whole.bvh", clip.text())
        out = self.folder / "evaluation.json"
        self.run_tool("evaluate", motion, "--robot", "unitree_g1", "--bvh", source, "--json", out,
                      "--gate", "none", *options)
        return json.loads(out.read_text())["motions"][0]["limb_angle_deg"][0]


class MissingFeet(OddBody):
    def test_ankles_alone_are_feet(self):
        for rename in (lambda clip: clip, with_other_names):
            whole = rename(Bvh(sample("walk")))
            expected, _, _ = self.run_clip(whole, name="expected")
            clip = Bvh(sample("walk"))
            clip.drop(*TOES)
            for joint in clip.joints:
                joint.ends = []
            rows, said, _ = self.run_clip(rename(clip))
            self.assertNotIn("no feet", said)
            self.assertIn("contact phase", said)
            # The same body, up to the length of a foot, which the file lacks.
            self.assertLess(abs(rows[:, :3] - expected[:, :3]).max(), 0.05)
            self.assertLess(numpy.degrees(abs(rows[:, 7:] - expected[:, 7:]).mean()), 2.5)

    def test_forearms_alone_have_hands(self):
        for rename in (lambda clip: clip, with_other_names):
            expected, _, _ = self.run_clip(rename(Bvh(sample("walk"))), name="expected")
            clip = Bvh(sample("walk"))
            for side in ("Left", "Right"):
                hand = clip.joints[clip.index(f"{side}Hand")].offset
                clip.joints[clip.index(f"{side}ForeArm")].ends = [hand]
            clip.drop("LeftHand", "RightHand")
            rows, _, _ = self.run_clip(rename(clip))
            self.assertLess(abs(rows[:, :3] - expected[:, :3]).max(), 0.01)
            # All joints except for the wrists.
            joints = [7 + j for j in range(29) if j not in (19, 20, 21, 26, 27, 28)]
            self.assertLess(numpy.degrees(abs(rows[:, joints] - expected[:, joints]).mean()), 2.0)

    def test_the_published_method_takes_them_too(self):
        clip = Bvh(sample("walk"))
        clip.drop(*TOES)
        expected, _, _ = self.run_clip(Bvh(sample("walk")), "--method", "gmr", name="expected")
        rows, _, _ = self.run_clip(clip, "--method", "gmr")
        self.assertLess(abs(rows[:, :3] - expected[:, :3]).max(), 0.03)

    def test_an_upper_body(self):
        clip = Bvh(sample("wave"))
        clip.drop("LeftUpLeg", "RightUpLeg")
        rows, said, _ = self.run_clip(clip, "--partial", "--unit", "cm", "--up", "y")
        self.assertIn("the source has no feet", said)
        self.assertEqual(len(rows), clip.frames)
        # No height can be measured, so none is required either.
        failed = self.retarget("--partial", "--height", "1.75", "--up", "y", bvh="clip.bvh")
        self.assert_fails(failed, 3, "even with the given height", "--unit")
        self.assertNotIn("--height", failed.stderr)

    def test_one_leg(self):
        for side in ("Left", "Right"):
            clip = Bvh(sample("walk"))
            clip.drop(f"{side}UpLeg")
            rows, said, _ = self.run_clip(clip, "--partial", "--up", "y")
            self.assertIn(f"the source has no {side.lower()} foot", said)
            self.assertEqual(len(rows), clip.frames)

    def test_batch_continues(self):
        clip = Bvh(sample("wave"))
        clip.drop("LeftUpLeg", "RightUpLeg")
        self.write("in/a.bvh", clip.text())
        self.write("in/b.bvh", Bvh(sample("wave")).text())
        done = self.run_tool("batch", "in", "-o", "out", "--robot", "unitree_g1", "--partial",
                             "--unit", "cm", "--up", "y")
        self.assert_done(done)
        self.assertIn("out/a.csv", self.files())
        self.assertIn("out/b.csv", self.files())


class FramesInFront(OddBody):
    def test_a_frame_of_zeros_has_no_effect(self):
        for rename in (lambda clip: clip, with_other_names):
            expected, _, _ = self.run_clip(rename(Bvh(sample("walk"))), name="expected")
            clip = rename(Bvh(sample("walk")))
            clip.in_front([clip.zero_row()])
            rows, said, _ = self.run_clip(clip)
            self.assertIn("1 frame at the start skipped", said)
            self.assertEqual(rows.shape, expected.shape)
            self.assertLess(abs(rows - expected).max(), 1e-5)

    def test_frames_are_kept_on_request(self):
        clip = Bvh(sample("walk"))
        clip.in_front([clip.zero_row()])
        rows, said, _ = self.run_clip(clip, "--lead-in", "keep")
        self.assertNotIn("skipped", said)
        self.assertEqual(len(rows), clip.frames)
        # The frame affects only a few frames after it.
        expected, _, _ = self.run_clip(Bvh(sample("walk")), name="expected")
        self.assertLess(numpy.degrees(abs(rows[16:, 7:] - expected[15:, 7:]).mean()), 1.0)

    def test_a_frame_that_faces_backwards_is_handled(self):
        clip = Bvh(sample("walk"))
        first = [v[0].copy() for v in clip.values]
        # Half a turn about the vertical, in the order Z, Y, X of the root's channels.
        turn = (Bvh(sample("walk")).world()[1][0, 0])
        turned = numpy.diag([-1.0, 1.0, -1.0]) @ turn
        first[0][3:] = numpy.degrees([numpy.arctan2(turned[1, 0], turned[0, 0]),
                                      -numpy.arcsin(turned[2, 0]),
                                      numpy.arctan2(turned[2, 1], turned[2, 2])])
        clip.in_front([first] * 8)
        expected, _, _ = self.run_clip(Bvh(sample("walk")), name="expected")
        rows, _, _ = self.run_clip(clip, "--lead-in", "keep")
        # The turn does not wind up the trunk.
        self.assertLess(numpy.degrees(abs(rows[30:, 7:] - expected[22:, 7:]).mean()), 1.5)

    def test_requested_parts_are_exact(self):
        clip = Bvh(sample("walk"))
        clip.in_front([clip.zero_row()])
        rows, said, _ = self.run_clip(clip, "--frames", "0:40")
        self.assertNotIn("skipped", said)
        self.assertEqual(len(rows), 40)

    def test_foreign_motions_are_compared_with_all_frames(self):
        clip = Bvh(sample("walk"))
        clip.in_front([clip.zero_row()])
        self.run_clip(clip, "--lead-in", "keep")
        done = self.run_tool("evaluate", "clip.csv", "--robot", "unitree_g1", "--bvh", "clip.bvh",
                             "--gate", "none")
        self.assert_done(done)
        self.assertIn("they are kept", done.stderr)

    def test_parts_of_motions_with_many_frames_in_front(self):
        clip = Bvh(sample("walk"))
        clip.in_front([clip.zero_row()] * 60)
        _, _, report = self.run_clip(clip, "--method", "gmr", "--end", "6")
        self.run_tool("evaluate", "clip.csv", "--robot", "unitree_g1", "--bvh", "clip.bvh",
                      "--ik-config", "published", "--gate", "none", "--json", "e.json")
        evaluation = json.loads((self.folder / "e.json").read_text())
        self.assertAlmostEqual(evaluation["motions"][0]["limb_angle_deg"][0],
                               report["motions"][0]["limb_angle_deg"][0], 6)


class ToesThatTurnAsNoneDo(OddBody):
    def test_they_follow_the_feet(self):
        for rename in (lambda clip: clip, with_other_names):
            expected, _, _ = self.run_clip(rename(Bvh(sample("walk"))), name="expected")
            clip = rename(Bvh(sample("walk")))
            for joint, values in zip(clip.joints, clip.values):
                # In the second half the toes are turned by 180 degrees, which moves their ends by
                # about the foot's length.
                if joint.name.lower().endswith("toe"):
                    values[clip.frames // 2:, joint.channels.index("Xrotation")] += 180.0
            rows, said, _ = self.run_clip(clip)
            self.assertIn("the toes turn farther than toes can", said)
            self.assertLess(abs(rows[:, :3] - expected[:, :3]).mean(), 0.01)
            # As if they never turned.
            stiff = rename(Bvh(sample("walk")))
            for joint, values in zip(stiff.joints, stiff.values):
                if joint.name.lower().endswith("toe"):
                    values[:] = values.mean(axis=0)
            expected, _, _ = self.run_clip(stiff, name="stiff")
            self.assertLess(abs(rows[:, :3] - expected[:, :3]).max(), 0.01)


class RotationsThatCarryNothing(OddBody):
    def baked(self, clip, rotations):
        """Positions for every joint that the given world rotations (joints, 3, 3) bring to their place."""
        positions, _ = clip.world()
        for i, joint in enumerate(clip.joints):
            way = positions[:, i].copy()
            if joint.parent >= 0:
                way -= positions[:, joint.parent]
                way = way @ rotations[joint.parent]
            clip.values[i] = numpy.hstack([way, numpy.zeros((clip.frames, 3))])
            joint.channels = POSITIONS + ["Zrotation", "Yrotation", "Xrotation"]
        return clip

    def test_directions_win(self):
        for name in ("walk", "squat", "wave"):
            whole = Bvh(sample(name))
            clip = with_other_names(self.baked(Bvh(sample(name)), [numpy.eye(3)] * 99))
            _, said, _ = self.run_clip(clip)
            self.assertIn("rotations do not match the limbs", said)
            self.run_clip(with_other_names(whole), name="whole_motion")
            expected = self.limb_angle("whole_motion.csv", whole)
            self.assertLess(self.limb_angle("clip.csv", whole), expected + 3.0)

    def test_consistent_files_do_not_change(self):
        clip = Bvh(sample("walk"))
        expected, _, _ = self.run_clip(with_other_names(Bvh(sample("walk"))), name="expected")
        for i, joint in enumerate(clip.joints):
            if joint.parent < 0:
                continue
            clip.values[i] = numpy.hstack([numpy.tile(joint.offset, (clip.frames, 1)),
                                           clip.values[i]])
            joint.channels = POSITIONS + joint.channels
        rows, said, _ = self.run_clip(with_other_names(clip))
        self.assertNotIn("do not match the limbs", said)
        self.assertLess(abs(rows - expected).max(), 1e-5)


class PositionsNearZero(OddBody):
    def test_they_do_not_collapse_the_body(self):
        clip = Bvh(sample("walk"))
        expected, _, _ = self.run_clip(clip, name="expected")
        noise = numpy.random.default_rng(1)
        for i, joint in enumerate(clip.joints):
            if joint.parent < 0:
                continue
            clip.values[i] = numpy.hstack([noise.normal(0, 1e-6, (clip.frames, 3)),
                                           clip.values[i]])
            joint.channels = POSITIONS + joint.channels
        rows, said, _ = self.run_clip(clip)
        self.assertIn("near 0 compared with the OFFSET", said)
        self.assertLess(abs(rows - expected).max(), 1e-4)


if __name__ == "__main__":
    unittest.main()
