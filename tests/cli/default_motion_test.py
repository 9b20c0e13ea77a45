"""Properties of motions with default options: an upright trunk, likeness, a calm root, planted feet."""

import json
import math
import unittest

from tool import SHARED, SOURCE, ToolTest, read_rows, sample

ROBOTS = sorted(path.parent.name for path in SOURCE.glob("robots/**/model.xml"))


class DefaultMotion(ToolTest):
    def report_of_run(self, clip, robot="unitree_g1", *arguments):
        self.assert_done(self.run_tool("--bvh", clip, "--robot", robot, "-o", "out.csv", "-q",
                                       "--report", "report.json", *arguments))
        return json.loads((self.folder / "report.json").read_text())["motions"][0]

    def report_of_file(self, motion, clip):
        self.run_tool("evaluate", motion, "--robot", "unitree_g1", "--bvh", clip, "--gate", "none",
                      "--json", "report.json")
        return json.loads((self.folder / "report.json").read_text())["motions"][0]


class Heading(DefaultMotion):
    def test_the_joints_do_not_depend_on_the_heading(self):
        for clip in ("walk", "get_up"):
            motions = []
            for degrees in ("0", "37", "-140"):
                self.assert_done(self.run_tool("edit", "turn", sample(clip), degrees, "-o", "turned.bvh"))
                self.assert_done(self.run_tool("--bvh", "turned.bvh", "--robot", "unitree_g1", "-q", "-o",
                                               "out.csv"))
                motions.append([row[7:] for row in read_rows((self.folder / "out.csv").read_text())])
            for turned in motions[1:]:
                difference = max(abs(a - b) for one, other in zip(motions[0], turned)
                                 for a, b in zip(one, other))
                self.assertLess(difference, 1e-3, clip)


class FrameRates(DefaultMotion):
    def test_a_walk_is_as_calm_and_its_feet_as_still_at_high_rates(self):
        at_30 = self.report_of_run(sample("walk"))["stance_slip_mean"]
        for fps in ("50", "60", "100", "120"):
            with self.subTest(fps):
                report = self.report_of_run(sample("walk"), "unitree_g1", "--fps", fps)
                self.assertLess(report["com_acc_p99"], 20)
                self.assertLess(report["stance_slip_mean"], 1.2 * at_30)


class StandingStraight(DefaultMotion):
    def test_a_human_who_stands_straight_results_in_a_robot_that_stands_straight(self):
        # The person turns in place, upright within two degrees of the skeleton's T-pose.
        for robot in ROBOTS:
            with self.subTest(robot):
                lean = self.report_of_run(sample("turn_in_place"), robot)["trunk_lean"]
                self.assertLess(lean["human_deg"], 2.0)
                # Talos' thighs are thicker than the space between them, and push its pelvis aside.
                allowed = 5.0 if robot == "pal_talos" else 2.0
                self.assertLess(abs(lean["robot_deg"] - lean["human_deg"]), allowed)

    def test_a_human_who_has_got_up_stands_straight(self):
        # Only the last frame of the clip is standing.
        self.assert_done(self.run_tool("--bvh", sample("get_up"), "--robot", "unitree_g1", "-q", "-o",
                                       "whole.csv"))
        self.assert_done(self.run_tool("--bvh", sample("get_up"), "--robot", "unitree_g1", "-q", "-o",
                                       "end.csv", "--frames", "240:286"))
        whole, end = ([float(cell) for cell in
                       (self.folder / name).read_text().splitlines()[-1].split(",")]
                      for name in ("whole.csv", "end.csv"))
        self.assertLess(abs(whole[21] - end[21]), 0.02)
        self.assertLess(abs(whole[21]), 0.2)

    def test_a_robot_without_a_waist_bends_as_the_human_does(self):
        report = self.report_of_run(sample("squat"), "booster_k1")
        self.assertGreater(report["trunk_lean"]["human_deg"], 18.0)
        self.assertLess(report["trunk_lean_error_deg"][0], 2.5)


# Joint, parent and offset in cm of a human in T-pose, y up, facing z. The last number is the length of an end.
T_POSE = (("Hips", None, (0, 0, 0)), ("Spine", "Hips", (0, 10, 0)), ("Spine1", "Spine", (0, 24, 0)),
          ("Neck", "Spine1", (0, 20, 0)), ("Head", "Neck", (0, 10, 2), (0, 18, 0)),
          ("LeftShoulder", "Spine1", (4, 14, 0)), ("LeftArm", "LeftShoulder", (13, 2, 0)),
          ("LeftForeArm", "LeftArm", (28, 0, 0)), ("LeftHand", "LeftForeArm", (26, 0, 0), (18, 0, 0)),
          ("LeftUpLeg", "Hips", (9, -3, 0)), ("LeftLeg", "LeftUpLeg", (0, -42, 0)),
          ("LeftFoot", "LeftLeg", (0, -42, 0)), ("LeftToe", "LeftFoot", (0, -6, 14), (0, 0, 7)))


def human_in_t_pose(frames):
    """A BVH clip at 30 fps; a frame gives the angles of the left and right arm in degrees above the
    horizontal."""
    joints = [*T_POSE]
    for name, parent, *offsets in T_POSE:
        if name.startswith("Left"):
            joints.append((name.replace("Left", "Right"), parent.replace("Left", "Right"),
                           *((-x, y, z) for x, y, z in offsets)))
    order = []

    def hierarchy(name, parent, offset, end=None):
        order.append(name)
        channels = "Zrotation Yrotation Xrotation"
        yield f"{'JOINT' if parent else 'ROOT'} {name} {{ OFFSET {offset[0]} {offset[1]} {offset[2]}"
        yield f"CHANNELS 3 {channels}" if parent else f"CHANNELS 6 Xposition Yposition Zposition {channels}"
        for child in joints:
            if child[1] == name:
                yield from hierarchy(*child)
        if end:
            yield f"End Site {{ OFFSET {end[0]} {end[1]} {end[2]} }}"
        yield "}"

    lines = ["HIERARCHY", *hierarchy(*joints[0]), "MOTION", f"Frames: {len(frames)}", "Frame Time: 0.0333333"]
    for left, right in frames:
        turned = {"LeftArm": left, "RightArm": -right}
        lines.append("0 93 0 " + " ".join(f"{turned.get(name, 0)} 0 0" for name in order))
    return "\n".join(lines) + "\n"


def raised_arm(top, start, seconds):
    """The angles of an arm that is raised to the side, at 30 fps."""
    shares = [min(1, max(0, (frame / 30 - start) / seconds)) for frame in range(130)]
    return [-75 + (top + 75) * share * share * (3 - 2 * share) for share in shares]


class RaisedArms(DefaultMotion):
    def test_raising_both_arms_to_the_sides_does_not_turn_the_chest(self):
        for top in (60, 70, 80, 88):
            angles = raised_arm(top, 0.8, 1)[:100]
            clip = self.write("raised.bvh", human_in_t_pose(list(zip(angles, angles))))
            report = self.report_of_run(clip)
            rows = self.rows("out.csv")
            waist_yaw = [row[7 + 12] for row in rows]
            self.assertLess(max(map(abs, waist_yaw)), math.radians(4), top)
            self.assertLess(report["limb_angle_deg"][0], 2.8)
            # Shoulder pitch, roll and yaw, elbow.
            left, right = rows[80][7 + 15:7 + 19], rows[80][7 + 22:7 + 26]
            for a, b, sign in zip(left, right, (1, -1, -1, 1)):
                self.assertAlmostEqual(a, sign * b, delta=0.05, msg=top)

    def test_the_arms_move_alike_in_a_clip_and_its_mirror_image(self):
        # Both arms move to another branch, which one of them can reach earlier.
        for left, right in (((65, 1.0, 1.0), (85, 0.6, 1.0)), ((88, 0.6, 1.3), (70, 1.2, 0.9))):
            clip = self.write("raised.bvh",
                              human_in_t_pose(list(zip(raised_arm(*left), raised_arm(*right)))))
            motions = []
            for options in ((), ("--mirror",)):
                notes = " ".join(self.report_of_run(clip, "unitree_g1", *options)["fit"]["notes"])
                for arm in ("left", "right"):
                    self.assertIn(f"the {arm} arm was stuck on a wrong branch", notes)
                motions.append(self.rows("out.csv"))
            for row, mirrored in zip(*motions):
                # Shoulder pitch, roll and yaw, elbow.
                for a, b, sign in zip(row[7 + 15:7 + 19], mirrored[7 + 22:7 + 26], (1, -1, -1, 1)):
                    self.assertAlmostEqual(a, sign * b, delta=0.02, msg=(left, right))


class LikeThePublishedData(DefaultMotion):
    def setUp(self):
        super().setUp()
        if not SHARED.is_dir():
            self.skipTest("no folder of shared data: set RETARGET_SHARED to run this test")

    def test_fit_is_similar_and_smoother(self):
        for name in ("walk4_subject1", "dance1_subject2", "fallAndGetUp2_subject2"):
            with self.subTest(name):
                clip = SHARED / f"data/lafan1/{name}.bvh"
                ours = self.report_of_run(clip)
                theirs = self.report_of_file(SHARED / f"data/unitree_g1_csv/{name}.csv", clip)
                for figure in ("limb_angle_deg", "trunk_lean_error_deg"):
                    self.assertLess(ours[figure][0], theirs[figure][0], figure)
                self.assertLess(ours["root_jerk_mean"], theirs["root_jerk_mean"])
                self.assertLess(ours["trunk_lean_error_deg"][0], 2.0)
                self.assertEqual(ours["jumps"], 0)
                self.assertLess(ours["contact_slip_mean"], 0.001)
                self.assertLess(ours["self_all_1cm_pct"], 0.1)
                self.assertLess(ours["body_pen_1cm_pct"], 0.1)
                if name.startswith("walk"):
                    continue  # It has no such joint.
                self.assertLess(ours["flight_peak_max_cm"], 2.0)

    def test_the_waist_is_not_at_its_limit_in_dances(self):
        for name in ("lafan1/dance1_subject2",
                     "lafan1_cuts/dance1_subject1_stumbling_filtered_60fps"):
            self.report_of_run(SHARED / f"data/{name}.bvh")
            # The 22nd column; the joint moves from -0.52 to 0.52 rad.
            pitch = [float(line.split(",")[21])
                     for line in (self.folder / "out.csv").read_text().splitlines()]
            self.assertGreater(max(map(abs, pitch)), 0.2)
            at_limit = sum(abs(angle) > 0.51 for angle in pitch)
            self.assertLess(at_limit / len(pitch), 0.05, name)

    def test_arms_overhead_do_not_stray(self):
        found = self.report_of_run(SHARED / "data/dialects/cmu_3dsmax_jumping_jacks.bvh")
        self.assertLess(found["limb_angle_deg"][0], 6.0)


if __name__ == "__main__":
    unittest.main()
