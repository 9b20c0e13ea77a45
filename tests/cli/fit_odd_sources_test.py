"""The fit on synthetic clips of every kind terminates and satisfies its guarantees in the file."""

import json
import math
import re
import subprocess
import sys
import unittest

from optional_numpy import numpy
from tool import SOURCE, ToolTest, read_rows, sample

SLACK = 1e-9  # Tolerance for numbers with six digits.


@unittest.skipIf(numpy is None, "numpy is missing")
class OddSources(ToolTest):
    @classmethod
    def setUpClass(cls):
        robot = json.loads((SOURCE / "robots/unitree_g1/robot.json").read_text())
        model = (SOURCE / "robots/unitree_g1/model.xml").read_text()
        ranges = {name: [float(x) for x in both.split()] for name, both in
                  re.findall(r'<joint name="([^"]+)"[^>]*\brange="([^"]+)"', model)}
        ranges |= robot["limit_sets"][robot["default_limits"]].get("ranges", {})
        names = robot["joint_order"]
        cls.low, cls.high = numpy.array([ranges[name] for name in names]).T
        cls.speed = numpy.array([robot["speed_limits"][name] for name in names])

    def make(self, name, fps=30, *options):
        folder = f"{name}_{fps}"
        done = subprocess.run([sys.executable, SOURCE / "tools/samples/make_samples.py", "--only",
                               name, "--fps", str(fps), "-o", self.folder / folder, *options],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.folder / folder / f"{name}.bvh"

    def fit(self, clip, fps=30, *options):
        """Returns the rows of the motion after checking them."""
        self.assert_done(self.retarget("--method", "fit", "--fps", fps, *options, bvh=clip))
        rows = numpy.array(read_rows((self.folder / "out.csv").read_text()))
        self.assertTrue(numpy.isfinite(rows).all())
        self.assertLess(abs(numpy.linalg.norm(rows[:, 3:7], axis=1) - 1).max(), 2e-6)
        joints = rows[:, 7:]
        self.assertTrue((joints >= self.low - SLACK).all() and (joints <= self.high + SLACK).all())
        if len(rows) > 1:
            self.assertGreater((rows[1:, 3:7] * rows[:-1, 3:7]).sum(axis=1).min(), 0)
            steps = abs(numpy.diff(joints, axis=0))
            self.assertTrue((steps <= self.speed / fps + SLACK).all())
            self.assertLessEqual(steps.max(), 0.48)
        return rows

    def test_an_excerpt_that_lies_is_on_the_floor(self):
        options = ("--frames", "0:15", "--report", "report.json")
        result = self.retarget("--method", "fit", *options, bvh=sample("get_up"))
        self.assert_done(result)
        self.assertIn("the floor is where the lowest part of the body rests",
                      " ".join(result.stderr.split()))
        report = json.loads((self.folder / "report.json").read_text())["motions"][0]
        self.assertEqual(report["body_pen_1cm_pct"], 0.0)
        self.assertLess(abs(report["fit"]["floor_height_m"]), 0.03)

    def test_actions(self):
        for name in ("jump", "crawl", "cartwheel", "sit", "run"):
            with self.subTest(name):
                self.assertGreater(len(self.fit(self.make(name))), 30)

    def test_frame_rates(self):
        lengths = []
        for fps in (24, 60, 120):
            with self.subTest(fps):
                lengths.append(len(self.fit(self.make("jump", fps), fps)) / fps)
        self.assertLess(max(lengths) - min(lengths), 0.1)

    def test_standing_still_for_a_minute_stands_still(self):
        rows = self.fit(self.make("stand_still", 10, "--duration", "60"))
        self.assertEqual(len(rows), 1801)
        # Breathing moves the root by two millimetres.
        self.assertLess(numpy.ptp(rows[:, :3], axis=0).max(), 0.01)

    def test_one_and_two_frames(self):
        self.assertEqual(len(self.fit(self.make("one_frame"))), 1)
        self.assertEqual(len(self.fit(self.make("two_frames"))), 2)

    def test_a_clip_that_starts_in_the_air(self):
        # The jump is in flight from 1.30 to 1.65 s.
        jump = self.make("jump")
        rows = self.fit(jump, 30, "--frames", "43:90")
        self.assertEqual(len(rows), 47)
        # A flight occurs only there.
        self.assertEqual(len(self.fit(jump, 30, "--frames", "41:48")), 7)

    def test_feet_through_the_floor(self):
        head, tail = self.make("jump").read_text().split("Frame Time:")
        lines = tail.splitlines()
        sunk = [lines[0]]
        for number, line in enumerate(lines[1:]):
            values = line.split()
            if len(values) > 3:
                # In the second half everything sinks by up to 30 cm.
                values[1] = str(float(values[1]) - min(30.0, max(0.0, number - 60.0)))
            sunk.append(" ".join(values))
        clip = self.write("sunk.bvh", head + "Frame Time:" + "\n".join(sunk) + "\n")
        rows = self.fit(clip)
        # The robot stays above its floor: a root as low as the clip's would put the legs into it.
        self.assertGreater(rows[:, 2].min(), 0.2)

    def test_a_jump_keeps_its_height(self):
        clip = self.make("jump")
        self.assert_done(self.retarget("--method", "fit", "--report", "report.json", bvh=clip))
        report = json.loads((self.folder / "report.json").read_text())["motions"][0]
        self.assertEqual(report["flights"], 1)
        self.assertLess(report["flight_peak_max_cm"], 2.0)
        self.assertTrue(math.isfinite(report["contact_slip_mean"]))


if __name__ == "__main__":
    unittest.main()
