"""`--reference-rate`: files beside a motion, from runs and from `convert`."""

import csv
import json
import unittest

from optional_numpy import numpy as np
from tool import ToolTest, absent, sample


class References(ToolTest):
    def setUp(self):
        super().setUp()
        if np is None:
            absent("numpy is not installed")

    def test_a_run_writes_a_reference_next_to_the_motion(self):
        self.assert_done(self.retarget("-q", "--end", "1.5", bvh=sample("walk"), output="plain.csv"))
        result = self.retarget("--end", "1.5", "--reference-rate", "200", "--sidecar",
                               bvh=sample("walk"), output="walk.csv")
        self.assert_done(result)
        self.assertIn("walk.reference.npz: 301 samples at 200 per second", result.stderr)
        self.assertEqual((self.folder / "plain.csv").read_bytes(),
                         (self.folder / "walk.csv").read_bytes())
        options = json.loads((self.folder / "walk.csv.json").read_text())["options"]
        self.assertNotIn("reference", options)
        self.assertNotIn("reference-rate", options)
        reference = np.load(self.folder / "walk.reference.npz")
        self.assertEqual(reference["qpos"].shape, (301, 36))
        self.assertEqual(reference["qvel"].shape, (301, 35))
        self.assertEqual(reference["torque"].shape, (301, 29))
        self.assertEqual(reference["planted"].shape, (301, 4))
        self.assertTrue(reference["planted"].any())
        points = len(reference["contact_names"])
        self.assertEqual(reference["contact_force"].shape, (301, points, 3))
        self.assertTrue(np.all(reference["qpos"][:, 7:] <= reference["joint_upper"]))
        self.assertTrue(np.all(reference["qpos"][:, 7:] >= reference["joint_lower"]))
        self.assertTrue(np.all(abs(reference["qvel"][:, 6:]) <= reference["speed_limits"]))
        # The motion and its forces agree.
        needed = reference["mass"] * (reference["com_acc"] + [0.0, 0.0, 9.81])
        forces = reference["contact_force"].sum(axis=1) + reference["residual"][:, :3]
        np.testing.assert_allclose(forces, needed, atol=1e-6)
        frames = np.loadtxt(self.folder / "walk.csv", delimiter=",")
        np.testing.assert_allclose(reference["qpos"][::20, :3], frames[::3, :3], atol=1e-6)

    def test_convert_makes_the_same_without_the_plan(self):
        self.assert_done(self.retarget("-q", "--end", "1", "--reference", "run.csv",
                                       bvh=sample("walk"), output="walk.csv"))
        self.assert_done(self.run_tool("convert", "walk.csv", "copy.csv", "--robot", "g1",
                                       "--reference", "copy.reference.csv"))
        with (self.folder / "run.csv").open() as file:
            run = list(csv.DictReader(file))
        with (self.folder / "copy.reference.csv").open() as file:
            copy = list(csv.DictReader(file))
        self.assertEqual(len(run), 201)
        self.assertEqual(len(copy), 201)
        self.assertIn("planted:left_heel", run[0])
        self.assertNotIn("planted:left_heel", copy[0])
        # The file has six decimals: errors of up to 5e-7. The second derivative of a cubic spline is
        # up to 12 * 30 * 30 times as large.
        for name, delta in (("time", 0.0), ("root_qw", 1e-6), ("q:left_knee_joint", 1e-6),
                            ("v:left_knee_joint", 1e-4), ("a:left_knee_joint", 5.4e-3),
                            ("root_vx", 1e-4), ("com_x", 1e-5), ("com_vx", 1e-3)):
            for one, other in zip(run, copy):
                self.assertAlmostEqual(float(one[name]), float(other[name]), delta=delta)

    def test_equal_bytes_for_any_number_of_threads(self):
        for name in ("a", "b"):
            self.assert_done(self.retarget("-q", "--end", "1", "--reference-rate", "50",
                                           bvh=sample("squat"), output=f"{name}.csv"))
        self.assertEqual((self.folder / "a.reference.npz").read_bytes(),
                         (self.folder / "b.reference.npz").read_bytes())

    def test_invalid_requests_are_rejected(self):
        for rate in ("5", "2000", "fast"):
            self.assert_fails(self.retarget("--reference-rate", rate), 2, "--reference-rate")
        self.assert_fails(self.retarget("--reference", "walk.json"), 2,
                          "neither an NPZ nor a CSV file")
        self.assert_fails(self.retarget("--reference-rate", "50", output="-"), 2,
                          "--reference-rate needs a file")
        self.assert_fails(self.retarget("--reference", "out.csv", output="out.csv"), 2, "out.csv")
        clips = self.folder / "clips"
        clips.mkdir()
        result = self.run_tool("batch", "clips", "-o", "out", "--robot", "g1", "--reference-rate",
                               "50")
        self.assert_fails(result, 2, "--reference-rate")


if __name__ == "__main__":
    unittest.main()
