"""Source fingers in the columns of a robot's hands: followed, relaxed, ignored, measured."""

import json
import math
import re
import unittest

from optional_numpy import numpy
from tool import ToolTest, read_rows, sample, short_clip

FRAMES = 90

# By finger: knuckle (along the hand, to the thumb's side, out of the palm) and bones, centimetres.
FINGERS = {
    "Thumb": ((2.5, 2.2, 1.2), (4.6, 3.2, 2.6)),
    "Index": ((9.0, 2.5, 0.0), (4.0, 2.3, 2.0)),
    "Middle": ((9.2, 0.5, 0.0), (4.5, 2.7, 2.1)),
    "Ring": ((8.5, -1.4, 0.0), (4.1, 2.6, 2.1)),
    "Pinky": ((7.8, -3.2, 0.0), (3.3, 1.8, 2.0)),
}
FIST = (80.0, 95.0, 50.0)


def hand_axes(side):
    """Returns rows along the hand, to the thumb's side, out of the palm, in LAFAN1's hand axes."""
    return ((1, 0, 0), (0, -1, 0), (0, 0, -1 if side == "Left" else 1))


def to_hand(side, palm):
    """Converts a position in the palm to an OFFSET of the hand joint."""
    axes = hand_axes(side)
    return [sum(palm[i] * axes[i][k] for i in range(3)) for k in range(3)]


def finger_lines(side):
    """Returns the finger joints of a hand as BVH hierarchy lines."""
    lines = []
    for finger, (knuckle, bones) in FINGERS.items():
        way = (0.75, 0.55, 0.35) if finger == "Thumb" else (1.0, 0.0, 0.0)
        length = math.sqrt(sum(w * w for w in way))
        places = [to_hand(side, knuckle)]
        places += [to_hand(side, [bone * w / length for w in way]) for bone in bones]
        for number, place in enumerate(places):
            name = f"JOINT {side}Hand{finger}{number + 1}" if number < 3 else "End Site"
            lines += [name, "{", "OFFSET " + " ".join(f"{p:.6f}" for p in place)]
            if number < 3:
                lines.append("CHANNELS 3 Zrotation Yrotation Xrotation")
        lines += ["}"] * 4
    return lines


def with_fingers(bvh, closing, still=()):
    """Returns a LAFAN1 clip with bending fingers; a fist where closing(frame) is 1.

    @param still  sides whose fingers stay at zero
    @return  the text of the BVH
    """
    head, motion = bvh.split("MOTION")
    lines, out, sides, side = head.split("\n"), [], [], None
    joints = 0
    for line in lines:
        word = line.strip()
        joint = re.match(r"(?:ROOT|JOINT) (.*)", word)
        if joint:
            joints += 1
            name = joint[1].strip()
            side = name[:-len("Hand")] if name in ("LeftHand", "RightHand") else None
        if word.startswith("End Site") and side:
            out += finger_lines(side)
            sides.append((side, 3 + 3 * joints))
            side = "skip"
        if side == "skip":
            side = None if word == "}" else side
            continue
        out.append(line)
    header, rows = motion.strip().split("\n")[:2], motion.strip().split("\n")[2:]
    frames = []
    for frame, row in enumerate(rows):
        values, done, result = row.split(), 0, []
        for side, end in sides:
            result += values[done:end]
            done = end
            sign = 1.0 if side == "Left" else -1.0
            for finger in FINGERS:
                for angle in FIST:
                    bent = 0.0 if finger == "Thumb" or side in still else sign * closing(frame) * angle
                    result += ["0", f"{bent:.6f}", "0"]
        frames.append(" ".join(result + values[done:]))
    return "\n".join(out) + "MOTION\n" + "\n".join(header + frames) + "\n"


class Hands(ToolTest):
    def setUp(self):
        super().setUp()
        plain = short_clip("wave", FRAMES).decode()
        close = lambda frame: min(1.0, max(0.0, (frame - 30) / 20.0))
        self.clip = str(self.write("fingers.bvh", with_fingers(plain, close)))

    def columns(self, *arguments, robot="unitree_g1_with_hands", **options):
        """{column: values} of a run."""
        result = self.retarget("--csv-header", *arguments, bvh=self.clip, robot=robot, output="-",
                               **options)
        self.assert_done(result)
        header, body = result.stdout.split("\n", 1)
        return dict(zip(header.split(","), zip(*read_rows(body))))

    def test_fingers_close_as_the_humans_do(self):
        found = self.columns()
        for side, sign in (("left", -1.0), ("right", 1.0)):
            for joint in ("index_0", "index_1", "middle_0", "middle_1"):
                values = [sign * value for value in found[f"{side}_hand_{joint}_joint"]]
                self.assertLess(max(values[:25]), 0.2)
                self.assertGreater(min(values[60:]), 1.2)

    def test_the_body_moves_as_without_fingers(self):
        follow, off = self.columns(), self.columns("--hands", "off")
        fingers = [name for name in follow if "_hand_" in name]
        self.assertEqual(len(fingers), 14)
        for name, values in follow.items():
            if name not in fingers:
                # The arms differ only where they keep the hands out of the thighs.
                self.assertLess(max(abs(a - b) for a, b in zip(values, off[name])), 0.2, name)
        self.assertEqual({value for name in fingers for value in off[name]}, {0.0})
        relaxed = self.columns("--hands", "relaxed")
        self.assertTrue(all(len(set(relaxed[name])) == 1 for name in fingers))
        plain = self.columns(robot="unitree_g1")
        self.assertEqual(plain, self.columns("--hands", "off", robot="unitree_g1"))

    def test_the_body_keeps_clear_of_its_fingers(self):
        """A fit uses their final pose: half open next to the thighs while getting up."""
        ways = []
        for hands in ("relaxed", "off"):
            self.assert_done(self.retarget("--hands", hands, "--report", "r.json",
                                           bvh=sample("get_up"), robot="unitree_g1_with_hands"))
            motion, = json.loads((self.folder / "r.json").read_text())["motions"]
            self.assertLess(motion["self_all_1cm_pct"], 0.5, hands)
            ways.append(read_rows((self.folder / "out.csv").read_text()))
        moved = max(abs(a - b) for one, other in zip(*ways) for a, b in zip(one[:29], other[:29]))
        self.assertGreater(moved, 1e-3)

    def test_the_body_keeps_clear_of_hands_that_close(self):
        """Fists beside the hips are thicker than the open hands of the first frame."""
        plain = short_clip("wave", FRAMES).decode()
        self.clip = str(self.write("fists.bvh", with_fingers(plain, lambda frame: min(1.0, frame / 40.0))))
        result = self.retarget("--gate", "self_1cm_pct<=1", "--gate", "fast_3pi_pct<=0.2", bvh=self.clip,
                               robot="unitree_g1_with_hands")
        self.assert_done(result)

    def test_a_pose_held_during_an_excerpt(self):
        found = self.columns("--start", "2")
        self.assertLess(max(found["left_hand_index_0_joint"]), -1.2)
        self.assertGreater(min(found["right_hand_index_0_joint"]), 1.2)

    def test_the_note_about_a_mirrored_clip_names_the_moving_side(self):
        plain = short_clip("wave", FRAMES).decode()
        close = lambda frame: min(1.0, frame / 40.0)
        self.clip = str(self.write("one.bvh", with_fingers(plain, close, still=("Right",))))
        for arguments, note in (((), r"hands +left following the human, right relaxed"),
                                (("--mirror",), r"hands +right following the human, left relaxed")):
            result = self.retarget(*arguments, bvh=self.clip, robot="unitree_g1_with_hands")
            self.assertRegex(result.stderr, note)

    def test_mirroring_keeps_the_order_of_the_notes(self):
        scene = str(self.write("box.json", json.dumps({"bodies": [{
            "name": "box", "shapes": [{"type": "box", "size": [1, 1, 1]}], "position": [5, 5, 0.5]}]})))
        orders = []
        for arguments in ((), ("--mirror",)):
            result = self.retarget("--scene", scene, *arguments, bvh=self.clip,
                                   robot="unitree_g1_with_hands")
            self.assert_done(result)
            orders.append(re.findall(r"^(?:retarget: )?(hands|scene) ", result.stderr, re.M))
        self.assertEqual(orders, [["hands", "scene"]] * 2)

    def test_the_fit_does_not_bound_the_fingers(self):
        result = self.retarget("--report", "r.json", bvh=self.clip, robot="unitree_g1_with_hands")
        self.assert_done(result)
        motion, = json.loads((self.folder / "r.json").read_text())["motions"]
        fingers = [bound["joint"] for bound in motion["fit"]["bounded"] if "_hand_" in bound["joint"]]
        self.assertEqual(fingers, [])

    def test_a_lost_end_does_not_move_the_fingers(self):
        """The run leaves the frames of zeros out, so the fingers hold a default curl in all others."""
        curled = with_fingers(short_clip("wave", FRAMES).decode(), lambda frame: 0.3)
        zeros = " ".join("0" for _ in curled.splitlines()[-1].split())
        longer = curled.replace(f"Frames: {FRAMES}", f"Frames: {FRAMES + 5}") + f"{zeros}\n" * 5
        self.clip = str(self.write("lost.bvh", longer))
        result = self.retarget(bvh=self.clip, robot="unitree_g1_with_hands")
        self.assertRegex(result.stderr, r"5 frames at the end skipped")
        self.assertRegex(result.stderr, r"hands +left and right relaxed")

    def test_published_method_has_fingers_on_request(self):
        exact, follow = (self.columns("--method", "gmr", *more) for more in ((), ("--hands", "follow")))
        self.assertEqual(set(exact["left_hand_index_0_joint"]), {0.0})
        self.assertLess(follow["left_hand_index_0_joint"][-1], -1.2)
        self.assertEqual(exact["left_elbow_joint"], follow["left_elbow_joint"])

    def test_a_robot_without_fingers(self):
        for hands in ("relaxed", "follow", "off"):
            run = self.retarget("--hands", hands, "--frames", ":30", bvh=sample("walk"))
            self.assertIn("no fingers to move", run.stderr, hands)
        self.assertNotIn("fingers", self.retarget("--frames", ":30", bvh=sample("walk")).stderr)

    @unittest.skipIf(numpy is None, "numpy is missing")
    def test_fingers_of_smplx(self):
        frames = 60
        poses = numpy.zeros((frames, 165))
        poses[:, 0] = math.pi / 2  # stands along z
        bend = numpy.clip((numpy.arange(frames) - 10) / 20.0, 0.0, 1.0)
        # Fingers point along x, palms down: the left ones close about -z; thumbs, the last three,
        # do not move.
        for joint in range(12):
            poses[:, 75 + 3 * joint + 2] = -1.4 * bend
            poses[:, 120 + 3 * joint + 2] = 1.4 * bend
        numpy.savez(self.folder / "smplx.npz", poses=poses, trans=numpy.zeros((frames, 3)),
                    betas=numpy.zeros(10), mocap_frame_rate=30.0, gender="neutral")
        self.clip = str(self.folder / "smplx.npz")
        found = self.columns()
        for side, sign in (("left", -1.0), ("right", 1.0)):
            values = [sign * value for value in found[f"{side}_hand_middle_0_joint"]]
            self.assertLess(max(values[:8]), 0.2)
            self.assertGreater(min(values[40:]), 1.2)
        self.assertEqual(self.columns(robot="unitree_g1"),
                         self.without_fingers(poses, robot="unitree_g1"))

    def without_fingers(self, poses, **options):
        """Returns the columns of the same motion from a file without fingers."""
        numpy.savez(self.folder / "body.npz", poses=poses[:, :66], trans=numpy.zeros((len(poses), 3)),
                    betas=numpy.zeros(10), mocap_frame_rate=30.0, gender="neutral",
                    surface_model_type="smplx")
        self.clip = str(self.folder / "body.npz")
        return self.columns(**options)

    def test_summary_and_figures(self):
        result = self.retarget(bvh=self.clip, robot="unitree_g1_with_hands")
        self.assert_done(result)
        self.assertRegex(result.stderr, r"hands +left and right following the human")
        result = self.retarget("--hands", "relaxed", bvh=self.clip, robot="unitree_g1_with_hands",
                               output="relaxed.csv")
        self.assertRegex(result.stderr, r"hands +left and right relaxed")
        measured = self.run_tool("evaluate", "out.csv", "relaxed.csv", "--robot",
                                 "unitree_g1_with_hands", "--bvh", self.clip, "--json", "-")
        follows, relaxed = json.loads(measured.stdout)["motions"]
        self.assertLess(follows["finger_angle_deg"][0], 15.0)
        self.assertGreater(relaxed["finger_angle_deg"][0], 40.0)
        # Only fingers that are driven have a gate.
        self.assertEqual(follows["driven_finger_angle_deg"], follows["finger_angle_deg"])
        self.assertNotIn("driven_finger_angle_deg", relaxed)
        strict = self.run_tool("evaluate", "out.csv", "relaxed.csv", "--robot", "unitree_g1_with_hands", "--bvh",
                               self.clip, "--gate", "none", "--gate", "driven_finger_angle_deg<=1", "--json", "-")
        self.assertEqual(strict.returncode, 1, strict.stderr)
        self.assertEqual([motion["passed"] for motion in json.loads(strict.stdout)["motions"]], [False, True])


if __name__ == "__main__":
    unittest.main()
