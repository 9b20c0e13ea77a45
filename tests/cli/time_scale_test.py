"""`--time-scale`: slower motions, what they keep, reports, sidecars and what refuses it."""

import json
import unittest

from tool import ToolTest, read_rows, sample

FAST = ("--source-fps", "90")  # three times as fast


class TimeScaleTest(ToolTest):
    def run_sample(self, name, output, *arguments):
        self.assert_done(self.retarget("-q", *arguments, bvh=sample(name), output=output))
        return (self.folder / output).read_bytes()

    def rows(self, name):
        return read_rows((self.folder / name).read_text())

    def report(self, name):
        return json.loads((self.folder / name).read_text())["motions"][0]


class Factor(TimeScaleTest):
    def test_a_factor_makes_the_motion_longer(self):
        self.run_sample("walk", "whole.csv")
        self.run_sample("walk", "slow.csv", "--time-scale", "0.8", "--report", "slow.json",
                        "--gate", "default")
        whole, slow = self.rows("whole.csv"), self.rows("slow.csv")
        self.assertAlmostEqual((len(slow) - 1) / (len(whole) - 1), 1.25, delta=0.01)
        for axis in (0, 1):
            self.assertAlmostEqual(slow[-1][axis], whole[-1][axis], delta=0.02)
        report = self.report("slow.json")
        self.assertEqual(report["fps"], 30)
        self.assertEqual(report["time_scale"]["least"], 0.8)
        self.assertTrue(report["passed"])

    def test_a_factor_of_one_changes_nothing(self):
        plain = self.run_sample("squat", "plain.csv", "--end", "2")
        self.assertEqual(self.run_sample("squat", "one.csv", "--end", "2", "--time-scale", "1"),
                         plain)

    def test_wrong_values(self):
        for value in ("0.2", "1.1", "fast", "nan", "-1"):
            result = self.retarget("--time-scale=" + value)
            self.assert_fails(result, 2, "--time-scale", "a number from 0.25 to 1 or `auto`")


class Auto(TimeScaleTest):
    def test_a_motion_within_limits_keeps_its_bytes(self):
        for name in ("squat", "walk"):
            plain = self.run_sample(name, "plain.csv")
            auto = self.run_sample(name, "auto.csv", "--time-scale", "auto", "--report",
                                   "auto.json", "--sidecar")
            self.assertEqual(plain, auto)
            self.assertNotIn("time_scale", self.report("auto.json"))
            found = json.loads((self.folder / "auto.csv.json").read_text())["found"]
            self.assertNotIn("time_scale", found)

    def test_a_fast_motion_becomes_slower_where_it_must(self):
        self.run_sample("wave", "fast.csv", *FAST, "--report", "fast.json")
        self.run_sample("wave", "slow.csv", *FAST, "--time-scale", "auto", "--report", "slow.json",
                        "--sidecar")
        fast, slow = self.report("fast.json"), self.report("slow.json")
        self.assertTrue(fast["fit"]["bounded"])  # Limits cut off the movement.
        self.assertFalse(slow["fit"]["bounded"])
        scale = slow["time_scale"]
        self.assertTrue(scale["stretches"])
        self.assertIn("speed", scale["stretches"][0]["cause"])
        self.assertGreaterEqual(scale["least"], 0.25)
        self.assertLess(scale["least"], 0.95)
        self.assertGreater(slow["frames"], fast["frames"])
        self.assertAlmostEqual(scale["longer_s"], (slow["frames"] - fast["frames"]) / 30,
                               delta=0.05)
        self.assertLess(slow["limb_angle_deg"], fast["limb_angle_deg"] + 0.05)
        self.assert_done(self.run_tool("verify", "slow.csv.json"))

    def test_evaluate_uses_the_times_of_the_sidecar(self):
        self.run_sample("wave", "slow.csv", *FAST, "--time-scale", "auto", "--report", "run.json",
                        "--sidecar")
        wanted = self.report("run.json")

        def evaluate(*extra):
            self.run_tool("evaluate", "slow.csv", "--robot", "g1", "--bvh", sample("wave"), *FAST,
                          "--json", "measured.json", *extra)
            return self.report("measured.json")

        found = evaluate()
        for key in ("limb_angle_deg", "lag_s", "root_slide_mean"):
            self.assertAlmostEqual(found[key], wanted[key], delta=1e-9)
        (self.folder / "slow.csv.json").unlink()
        again = evaluate("--time-scale", "auto")
        self.assertAlmostEqual(again["limb_angle_deg"], wanted["limb_angle_deg"], delta=1e-9)
        other = evaluate()
        self.assertGreater(other["limb_angle_deg"], wanted["limb_angle_deg"] + 1.0)

    def test_without_it_reports_and_sidecars_do_not_name_it(self):
        self.run_sample("walk", "out.csv", "--end", "1", "--sidecar", "--report", "out.json")
        for name in ("out.json", "out.csv.json"):
            text = (self.folder / name).read_text()
            for word in ('"time_scale"', '"time-scale"', '"reference'):
                self.assertNotIn(word, text)

    def test_a_batch_gives_the_bytes_of_a_run(self):
        clips = self.folder / "clips"
        clips.mkdir()
        (clips / "wave.bvh").write_bytes(sample("wave").read_bytes())
        self.assert_done(self.run_tool("batch", "clips", "-o", "out", "--robot", "g1", *FAST,
                                       "--time-scale", "auto"))
        alone = self.run_sample("wave", "wave.csv", *FAST, "--time-scale", "auto")
        self.assertEqual((self.folder / "out" / "wave.csv").read_bytes(), alone)


if __name__ == "__main__":
    unittest.main()
