"""Joints at their limits in the summary and in reports, also of robots with a fixed base."""

import json
import unittest

from tool import SOURCE, ToolTest


class LimitedJoints(ToolTest):
    def test_joints_at_a_limit_are_in_summary_and_report(self):
        result = self.run_tool("--bvh", SOURCE / "data" / "walk.bvh", "--robot", "unitree_g1",
                               "--method", "gmr", "-o", "w.csv", "--report", "run.json")
        self.assert_done(result)
        motion, = json.loads((self.folder / "run.json").read_text())["motions"]
        self.assertTrue(motion["limited_joints"])
        for joint in motion["limited_joints"]:
            self.assertGreaterEqual(joint["frames_pct"], 5.0)
            self.assertIn(f"{joint['joint']} at its {joint['side']} limit", result.stderr)
            self.assertIn(f"task {joint['task']} {joint['part']}", result.stderr)
            self.assertGreater(joint["short_deg" if joint["part"] == "rotation" else "short_cm"],
                               0.0)

    def test_joints_at_a_limit_do_not_depend_on_the_start(self):
        def limited(*options):
            self.assert_done(self.run_tool("--bvh", SOURCE / "data" / "walk.bvh", "--robot",
                                           "unitree_g1", "--method", "gmr", "--start", "5",
                                           "-o", "w.csv", "--report", "run.json", *options))
            motion, = json.loads((self.folder / "run.json").read_text())["motions"]
            return motion["limited_joints"]
        expected, found = limited(), limited("--normalize-start")
        self.assertTrue(expected)
        self.assertEqual([(joint["joint"], joint["task"]) for joint in found],
                         [(joint["joint"], joint["task"]) for joint in expected])
        for before, after in zip(expected, found):
            for key in ("short_deg", "short_cm"):
                if key in before:
                    self.assertAlmostEqual(after[key], before[key], delta=1e-3)

    def test_a_fixed_base_has_no_contacts_and_no_dynamics(self):
        run = ("--bvh", SOURCE / "data" / "walk.bvh", "--robot", "unitree_g1", "--end", "2", "--base",
               "fixed")
        self.assert_done(self.run_tool(*run, "-o", "w.csv", "--dynamics", "--report", "run.json"))
        motion, = json.loads((self.folder / "run.json").read_text())["motions"]
        self.assertNotIn("dynamics_bad_pct", motion)
        self.assert_fails(self.run_tool(*run, "-o", "c.csv", "--contacts", "contacts.csv"), 2,
                          "no contacts")
        self.assertFalse((self.folder / "c.csv").exists())

    def test_a_fixed_base_has_joints_at_a_limit(self):
        result = self.run_tool("--bvh", SOURCE / "data" / "walk.bvh", "--robot", "unitree_g1",
                               "--method", "gmr", "--base", "fixed", "-o", "w.csv", "--sidecar",
                               "--report", "run.json")
        self.assert_done(result)
        motion, = json.loads((self.folder / "run.json").read_text())["motions"]
        self.assertTrue(motion["limited_joints"])
        for joint in motion["limited_joints"]:
            if joint["task"]:
                self.assertIn(f"{joint['joint']} at its {joint['side']} limit", result.stderr)
        self.assert_done(self.run_tool("evaluate", "w.csv", "--robot", "unitree_g1", "--bvh",
                                       SOURCE / "data" / "walk.bvh", "--json", "e.json", "--gate",
                                       "none"))
        again, = json.loads((self.folder / "e.json").read_text())["motions"]
        self.assertEqual(again["limited_joints"], motion["limited_joints"])


if __name__ == "__main__":
    unittest.main()
