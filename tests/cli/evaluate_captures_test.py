"""`retarget evaluate` and --report on captured motions, compared with the independent judge and published figures."""

import json
import os
import shutil
import subprocess
import sys
import unittest

from tool import SHARED, ToolTest

JUDGE = SHARED / "judge" / "judge.py"
REFERENCE = SHARED / "reference" / "robots" / "unitree_g1"
IK_CONFIG = SHARED / "reference" / "ik_configs" / "bvh_to_g1.json"
PUBLISHED = SHARED / "data" / "unitree_g1_csv"
LAFAN1 = SHARED / "data" / "lafan1"
CLIPS = ("dance1_subject2", "fallAndGetUp2_subject2", "walk4_subject1")


def judge_python():
    """A Python that can run the judge: RETARGET_JUDGE_PYTHON, this one, or python3."""
    for python in (os.environ.get("RETARGET_JUDGE_PYTHON"), sys.executable, "python3"):
        if python and shutil.which(python) and subprocess.run(
                [python, "-c", "import mujoco, numpy"], stderr=subprocess.DEVNULL).returncode == 0:
            return python
    return None


def cut_bvh(clip, start, stop):
    """Returns frames [start, stop) of a BVH as text."""
    lines = (LAFAN1 / f"{clip}.bvh").read_text().splitlines(keepends=True)
    first = next(i for i, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    header = [f"Frames: {stop - start}\n" if line.startswith("Frames:") else line
              for line in lines[:first]]
    return "".join(header + lines[first + start:first + stop])


class AgainstTheJudge(ToolTest):
    """The figures equal those of a judge without code of this project."""

    def setUp(self):
        super().setUp()
        if not JUDGE.exists():
            self.skipTest("no folder of shared data: set RETARGET_SHARED to run this test")
        self.python = judge_python()
        if self.python is None:
            self.skipTest("no Python with mujoco and numpy: set RETARGET_JUDGE_PYTHON")

    def judged(self, csv, bvh, *options):
        command = [self.python, JUDGE, "--robot", REFERENCE, "--limits",
                   REFERENCE / "g1_29dof_rev_1_0.xml", "--bvh", bvh, "--ik-config", IK_CONFIG,
                   *options, csv]
        result = subprocess.run(list(map(str, command)), cwd=self.folder, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def assert_agree(self, motion, judged):
        self.assertGreater(len(judged), 20)
        for key, value in judged.items():
            self.assertIn(key, motion)
            if isinstance(value, str):
                self.assertEqual(motion[key], value)
                continue
            found, wanted = (x if isinstance(x, list) else [x] for x in (motion[key], value))
            self.assertEqual(len(found), len(wanted), key)
            for a, b in zip(found, wanted):
                self.assertLess(abs(a - b), 1e-6, f"{key}: {motion[key]} for {value}")

    def evaluate(self, *arguments):
        result = self.run_tool("evaluate", *arguments, "--robot", "unitree_g1", "--ik-config",
                               IK_CONFIG, "--limits", REFERENCE / "g1_29dof_rev_1_0.xml", "--json",
                               "report.json", "--gate", "none")
        self.assert_done(result)
        return json.loads((self.folder / "report.json").read_text())["motions"]

    def test_published_motions(self):
        # Parts with jumps, in the middle of a fall, and of walking.
        for clip, start in zip(CLIPS, (500, 1500, 3000)):
            with self.subTest(clip):
                lines = (PUBLISHED / f"{clip}.csv").read_text().splitlines(keepends=True)
                csv = self.write(f"{clip}.csv", "".join(lines[start:start + 250]))
                bvh = self.write("source.bvh", cut_bvh(clip, start - 60, start + 300))
                motion, = self.evaluate(csv, "--bvh", bvh, "--start", "2")
                self.assert_agree(motion, self.judged(csv, bvh, "--start", 60))

    def test_own_motion_with_its_report(self):
        bvh = self.write("source.bvh", cut_bvh("dance1_subject2", 270, 450))
        self.assert_done(self.retarget("--frames", "30:180", "--ik-config", IK_CONFIG, "--limits",
                                       REFERENCE / "g1_29dof_rev_1_0.xml", "--report", "run.json",
                                       bvh=bvh))
        judged = self.judged("out.csv", bvh, "--start", 30)
        motion, = self.evaluate("out.csv", "--bvh", bvh, "--start", "1")
        self.assert_agree(motion, judged)
        reported, = json.loads((self.folder / "run.json").read_text())["motions"]
        self.assert_agree(reported, judged)
        for key in set(motion) - {"gates", "passed"}:
            self.assertEqual(reported[key], motion[key], key)


class Crawling(ToolTest):
    """Feet on the instep, whose joints are as high as those of standing feet."""

    def test_soles_of_feet_that_lie_are_not_judged(self):
        if not (LAFAN1 / "ground1_subject1.bvh").exists():
            self.skipTest("no folder of shared data: set RETARGET_SHARED to run this test")
        bvh = self.write("crawl.bvh", cut_bvh("ground1_subject1", 300, 600))
        result = self.retarget("--report", "run.json", bvh=bvh)
        self.assert_done(result)
        self.assertNotIn("missed   ", result.stderr)
        motion, = json.loads((self.folder / "run.json").read_text())["motions"]
        # By their heights some feet stand, but no sole is near the floor.
        self.assertGreater(motion["contact_pct"], 3)
        self.assertNotIn("stance_height_p50_cm", motion)
        # Elbows, knees and insteps support the body.
        self.assertGreater(motion["support_pct"], 100)
        self.assertLess(motion["support_height_p50_cm"], 1.5)
        self.assertLess(motion["contact_height_p50_cm"], 1.5)


class PublishedFigures(ToolTest):
    """Figures of the published G1 data, measured independently (numpy, the reference MJCF)."""

    # clip: foot penetration over 1 cm (% of frames) and depth (cm), peak speed (rad/s), faster
    # than 3 pi (%), frames with a step, beyond the model's limits by 1 mrad (%)
    FIGURES = {"dance1_subject2": ("3.9", "3.6", "32.7", "29.61", "189", "4.0"),
               "fallAndGetUp2_subject2": ("13.5", "4.1", "15.4", "5.74", "3", "29.0"),
               "walk4_subject1": ("0.0", "0.6", "16.5", "0.87", "1", "0.7")}

    def test_of_whole_clips(self):
        model = REFERENCE / "g1_mocap_29dof.xml"
        if not model.exists():
            self.skipTest("no folder of shared data: set RETARGET_SHARED to run this test")
        # Only the four spheres under each foot of this model need no mesh.
        result = self.run_tool("evaluate", *(PUBLISHED / f"{clip}.csv" for clip in CLIPS),
                               "--robot-xml", model, "--limits",
                               REFERENCE / "g1_29dof_rev_1_0.xml", "--gate", "none", "--json", "-")
        self.assert_done(result)
        for motion in json.loads(result.stdout)["motions"]:
            found = (f"{motion['body_pen_1cm_pct']:.1f}", f"{motion['body_pen_max_cm']:.1f}",
                     f"{motion['peak_speed']:.1f}", f"{motion['fast_3pi_pct']:.2f}",
                     f"{motion['jump_frames']:.0f}",
                     f"{motion['limit_sets']['model']['frames_1mrad_pct']:.1f}")
            self.assertEqual(found, self.FIGURES[motion["file"].removesuffix(".csv")])
            self.assertEqual(motion["limit_pct"], 0)


if __name__ == "__main__":
    unittest.main()
