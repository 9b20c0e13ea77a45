"""Motions that are good pass all gates, and spoiled in any of the usual ways they miss one: on bodies that stand, that
get up, and that crawl all the time."""

import json
import math
import random
import subprocess
import sys
import unittest

from tool import SOURCE, ToolTest, absent, read_rows, sample

FPS = 30
ROOT = 7  # columns of the root: place and quaternion (x, y, z, w)
WAIST_YAW, WAIST_ROLL, WAIST_PITCH = 12, 13, 14  # joints of a G1
LEFT_SHOULDER_PITCH = 15
LEFT_HIP_PITCH, LEFT_ELBOW, RIGHT_WRIST_YAW = 0, 18, 28
LEGS, LEFT_ARM, ARMS = range(12), range(15, 22), range(15, 29)


def lifted(rows, metres):
    return [[*row[:2], row[2] + metres, *row[3:]] for row in rows]


def sliding(rows, speed, heading):
    """Carried along at a constant speed, m/s, while everything else is unchanged."""
    x, y = (speed * math.cos(heading) / FPS, speed * math.sin(heading) / FPS)
    return [[row[0] + i * x, row[1] + i * y, *row[2:]] for i, row in enumerate(rows)]


def tilted(rows, degrees, axis):
    """Turned about an axis of the world through the root."""
    half = math.radians(degrees) / 2
    turn = [math.sin(half) * a for a in axis] + [math.cos(half)]
    return [[*row[:3], *quaternion_product(turn, row[3:ROOT]), *row[ROOT:]] for row in rows]


def quaternion_product(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def at_heading(row, degrees):
    """Turned about the vertical through the origin."""
    angle = math.radians(degrees)
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = [0, 0, math.sin(angle / 2), math.cos(angle / 2)]
    return [cosine * row[0] - sine * row[1], sine * row[0] + cosine * row[1], row[2],
            *quaternion_product(turn, row[3:ROOT]), *row[ROOT:]]


def early(rows, frames):
    return rows[frames:] + [rows[-1]] * frames


def late(rows, frames):
    return [rows[0]] * frames + rows[:-frames]


def off_by(rows, joint, radians):
    return [[value + (radians if i == ROOT + joint else 0) for i, value in enumerate(row)]
            for row in rows]


def jolted(rows):
    """An arm drags the chest along for a third of a second, as at the limits of a shoulder."""
    middle = len(rows) // 2
    bump = [math.sin(math.pi * i / 10) ** 2 for i in range(11)]
    changed = [list(row) for row in rows]
    for row, share in zip(changed[middle:], bump):
        row[ROOT + WAIST_ROLL] += 0.5 * share
        row[ROOT + LEFT_SHOULDER_PITCH] += 0.9 * share
    return changed


def gliding(rows, frames):
    """The height of the root averaged over this many frames on either side."""
    heights = [row[2] for row in rows]
    means = []
    for i in range(len(rows)):
        around = heights[max(0, i - frames):i + frames + 1]
        means.append(sum(around) / len(around))
    return [[*row[:2], mean, *row[3:]] for row, mean in zip(rows, means)]


def drawling(rows, joints, frames):
    """These joints averaged over this many frames on either side."""
    changed = [list(row) for row in rows]
    for i, row in enumerate(changed):
        around = rows[max(0, i - frames):i + frames + 1]
        for joint in joints:
            row[ROOT + joint] = sum(near[ROOT + joint] for near in around) / len(around)
    return changed


def held(rows, joints):
    """These joints as in the first frame."""
    return [[rows[0][i] if i - ROOT in joints else value for i, value in enumerate(row)] for row in rows]


def moved_for(rows, frames, axis, metres):
    """The root moved along an axis for some frames in the middle."""
    middle = len(rows) // 2
    return [[value + (metres if k == axis and middle <= i < middle + frames else 0) for k, value in enumerate(row)]
            for i, row in enumerate(rows)]


def with_arms_exchanged(rows):
    """Each arm moves like the other one's mirror image."""
    signs = (1, -1, -1, 1, -1, 1, -1)  # Pitch, roll, yaw of the shoulder, elbow, roll, pitch, yaw of the wrist.
    left, right = ROOT + 15, ROOT + 22
    return [[*row[:left], *(s * v for s, v in zip(signs, row[right:right + 7])),
             *(s * v for s, v in zip(signs, row[left:left + 7]))] for row in rows]


def swaying(rows, joint, radians, hertz):
    return [[value + (radians * math.sin(2 * math.pi * hertz * t / FPS) if i == ROOT + joint else 0)
             for i, value in enumerate(row)] for t, row in enumerate(rows)]


def noisy(rows, radians):
    draw = random.Random(1)
    return [row[:ROOT] + [value + draw.gauss(0, radians) for value in row[ROOT:]] for row in rows]


def shaken(rows, metres):
    draw = random.Random(1)
    return [[value + draw.gauss(0, metres) for value in row[:3]] + row[3:] for row in rows]


# The perturbations of every motion, and the gates of which at least one must miss.
PERTURBATIONS = {
    "lifted": (lambda rows: lifted(rows, 0.04), {"hover_pct"}),
    "slides forward": (lambda rows: sliding(rows, 0.08, 0.0), {"root_slide_mean"}),
    "slides back": (lambda rows: sliding(rows, 0.08, math.pi), {"root_slide_mean"}),
    "slides to the left": (lambda rows: sliding(rows, 0.08, math.pi / 2), {"root_slide_mean"}),
    "tilts sideways": (lambda rows: tilted(rows, 10, (1, 0, 0)),
                       {"foot_pen_1cm_pct", "body_pen_1cm_pct", "stance_height_p50_cm"}),
    "tilts forward": (lambda rows: tilted(rows, 10, (0, 1, 0)),
                      {"foot_pen_1cm_pct", "body_pen_1cm_pct", "stance_height_p50_cm"}),
    "is early": (lambda rows: early(rows, 3), {"lag_s"}),
    "is late": (lambda rows: late(rows, 6), {"lag_s"}),
    "has a shoulder off": (lambda rows: off_by(rows, LEFT_SHOULDER_PITCH, 0.25),
                           {"joint_offset_rad"}),
    "has the waist off": (lambda rows: off_by(rows, WAIST_PITCH, -0.25),
                          {"joint_offset_rad", "trunk_lean_error_deg", "stance_height_p50_cm",
                           "body_pen_1cm_pct", "support_height_p95_cm"}),
    "is noisy": (lambda rows: noisy(rows, 0.03), {"com_acc_p99"}),
    "is elsewhere for a moment": (lambda rows: moved_for(rows, 8, 1, 0.2), {"root_acc_max"}),
    "is in the floor for a moment": (lambda rows: moved_for(rows, 8, 2, -0.15), {"body_pen_max_cm"}),
    "is shaken": (lambda rows: shaken(rows, 0.01), {"root_acc_p99"}),
}
# Perturbations that are visible in standing bodies, which do not rest on these limbs.
OF_STANDING = {
    "has a hip off": (lambda rows: off_by(rows, LEFT_HIP_PITCH, 0.2),
                      {"stance_height_p50_cm", "stance_slip_mean", "foot_pen_1cm_pct"}),
    "has the waist turned to the left": (lambda rows: off_by(rows, WAIST_YAW, 0.25),
                                         {"joint_offset_rad"}),
    "has the waist turned to the right": (lambda rows: off_by(rows, WAIST_YAW, -0.25),
                                          {"joint_offset_rad"}),
    "has an elbow off": (lambda rows: off_by(rows, LEFT_ELBOW, 0.2), {"joint_offset_rad"}),
    "has a wrist off": (lambda rows: off_by(rows, RIGHT_WRIST_YAW, -0.2), {"joint_offset_rad"}),
}


# Does not count while people lie.
JOLT = {"has a chest that jolts": (jolted, {"arm_jolts"})}
# Perturbations that are visible in bodies that rest on hands and knees.
ON_THE_FLOOR = {
    "hovers over its knees and hands": (lambda rows: lifted(rows, 0.04), {"support_height_p95_cm"}),
    "drags its hands": (lambda rows: swaying(rows, WAIST_YAW, 0.12, 0.7), {"support_slip_mean"}),
}


class Perturbations(ToolTest):
    def check(self, clip, perturbations):
        """The motion of a clip passes all gates; each perturbation misses one, by evaluate's exit code too."""
        result = self.run_tool("--bvh", clip, "--robot", "unitree_g1", "-o", "good.csv")
        self.assert_done(result)
        rows = read_rows((self.folder / "good.csv").read_text())
        good = self.judge(clip, rows, 0)
        self.assertEqual(good, set())
        for name, (perturb, expected) in perturbations.items():
            with self.subTest(clip.stem, perturbation=name):
                missed = self.judge(clip, perturb(rows), 1)
                self.assertTrue(missed & expected, f"missed {missed}, none of {expected}")

    def judge(self, clip, rows, exit_code):
        """Returns the missed gates of a motion."""
        text = "\n".join(",".join(f"{value:.7g}" for value in row) for row in rows)
        self.write("motion.csv", text + "\n")
        done = self.run_tool("evaluate", "motion.csv", "--robot", "unitree_g1", "--bvh", clip,
                             "--source-quat", "xyzw", "--json", "report.json")
        self.assertEqual(done.returncode, exit_code, done.stderr)
        motion = json.loads((self.folder / "report.json").read_text())["motions"][0]
        for gate in motion["gates"]:
            self.assertNotIn("not_applicable", gate)
        return {gate["metric"] for gate in motion["gates"] if not gate["passed"]}

    def made(self, name):
        """A clip of tools/samples that data/ does not have."""
        done = subprocess.run([sys.executable, SOURCE / "tools" / "samples" / "make_samples.py",
                               "--only", name, "-o", self.folder], capture_output=True, text=True)
        if "No module named 'numpy'" in done.stderr:
            absent("Python has no numpy")
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.folder / f"{name}.bvh"

    def test_walking(self):
        # The other clips hardly bounce.
        self.check(sample("walk"), PERTURBATIONS | OF_STANDING | JOLT | {
            "exchanges its arms": (with_arms_exchanged, {"lag_s"}),
            "glides": (lambda rows: gliding(rows, 4), {"root_bounce_pct"}),
            "drawls with its arms": (lambda rows: drawling(rows, ARMS, 10), {"fast_arm_pct"}),
            "holds an arm still": (lambda rows: held(rows, LEFT_ARM), {"fast_arm_pct"}),
            "drawls with its legs": (lambda rows: drawling(rows, LEGS, 10), {"fast_leg_pct"})})

    def test_waving(self):
        # In a clip with standing feet, stances alone do not show a slide.
        self.check(sample("wave"), PERTURBATIONS | OF_STANDING | JOLT)

    def test_getting_up(self):
        self.check(sample("get_up"), PERTURBATIONS | OF_STANDING | ON_THE_FLOOR)

    def test_the_heading_does_not_matter(self):
        self.assert_done(self.run_tool("--bvh", sample("get_up"), "--robot", "unitree_g1", "-o", "good.csv"))
        rows = read_rows((self.folder / "good.csv").read_text())
        found = []
        for degrees in (0, 90, 180):
            self.judge(sample("get_up"), [at_heading(row, degrees) for row in rows], 0)
            report = json.loads((self.folder / "report.json").read_text())["motions"][0]
            found.append(report)
        for report in found[1:]:
            for metric in ("support_slip_mean", "support_drift_p95_cm"):
                self.assertAlmostEqual(report[metric], found[0][metric], places=4, msg=metric)

    def test_crawling_all_the_time(self):
        self.check(self.made("crawl"), PERTURBATIONS | ON_THE_FLOOR)


class OfTheSource(ToolTest):
    def test_a_source_that_jumps(self):
        # The fit smooths the jump, and percentiles would hide it in a long clip.
        head, motion = sample("walk").read_text().split("MOTION\n")
        lines = motion.splitlines()
        middle = len(lines) // 2
        jumped = [f"{float(line.split()[0]) + 80.0} {' '.join(line.split()[1:])}" for line in lines[middle:]]
        self.write("jump.bvh", head + "MOTION\n" + "\n".join([*lines[:middle], *jumped]) + "\n")
        done = self.run_tool("--bvh", "jump.bvh", "--robot", "unitree_g1", "--gate", "default", "-o", "out.csv")
        self.assert_fails(done, 1, "root_acc_max")


class NeverOnTheFloor(ToolTest):
    def test_a_robot_without_planned_contacts(self):
        # Feet that are never still make no contact, so only hovering is noticed. (Cleaning would still them.)
        clip = sample("walk")
        self.assert_done(self.run_tool("--bvh", clip, "--robot", "unitree_g1", "-o", "good.csv"))
        rows = read_rows((self.folder / "good.csv").read_text())
        lines = clip.read_text().splitlines()
        motion = next(i for i, line in enumerate(lines) if line.startswith("Frames:"))
        # Each frame is one metre further, with the same pose: 30 m/s.
        slid = []
        for i, line in enumerate(lines[motion + 2:]):
            values = line.split()
            slid.append(" ".join([values[0], values[1], str(float(values[2]) + 100.0 * i), *values[3:]]))
        self.write("slid.bvh", "\n".join([*lines[:motion + 2], *slid]) + "\n")
        self.write("motion.csv", "\n".join(
            ",".join(f"{v:.7g}" for v in row) for row in lifted(rows, 0.3)) + "\n")
        done = self.run_tool("evaluate", "motion.csv", "--robot", "unitree_g1", "--bvh",
                             "slid.bvh", "--clean", "off", "--source-quat", "xyzw", "--json", "report.json",
                             "--gate", "none", "--gate", "float_planted_pct<=0.3",
                             "--gate", "hover_pct<=1")
        self.assertEqual(done.returncode, 1, done.stderr)
        motion = json.loads((self.folder / "report.json").read_text())["motions"][0]
        self.assertEqual([gate["metric"] for gate in motion["gates"] if not gate["passed"]],
                         ["hover_pct"])
        self.assertEqual(motion["float_planted_pct"], 0)


if __name__ == "__main__":
    unittest.main()
