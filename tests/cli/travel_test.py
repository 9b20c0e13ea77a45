"""`--travel` and `--for tracking`: files, reports, sidecars, batches, and what refuses them."""

import json
import math
import unittest

from tool import ToolTest, sample

FAST = ("--source-fps", "60")  # the walk, twice as fast


class TravelTest(ToolTest):
    def run_walk(self, output, *arguments):
        self.assert_done(self.retarget("-q", *arguments, bvh=sample("walk"), output=output))
        return (self.folder / output).read_bytes()

    def way(self, name):
        rows = self.rows(name)
        return math.hypot(rows[-1][0] - rows[0][0], rows[-1][1] - rows[0][1])


class Travel(TravelTest):
    def test_a_factor_scales_the_path_and_the_gates_pass(self):
        self.run_walk("whole.csv")
        self.run_walk("less.csv", "--travel", "0.9", "--report", "less.json", "--gate", "default")
        self.assertAlmostEqual(self.way("less.csv") / self.way("whole.csv"), 0.9, delta=0.005)
        report = self.report("less.json")
        self.assertEqual(report["travel"], {"factor": 0.9, "least": 0.9, "greatest": 0.9})
        self.assertTrue(report["passed"])

    def test_auto_leaves_a_slow_motion_as_it_is(self):
        self.assert_done(self.retarget("-q", bvh=sample("squat"), output="plain.csv"))
        self.assert_done(self.retarget("-q", "--travel", "auto", "--report", "auto.json",
                                       bvh=sample("squat"), output="auto.csv"))
        self.assertEqual((self.folder / "plain.csv").read_bytes(),
                         (self.folder / "auto.csv").read_bytes())
        self.assertEqual(self.report("auto.json")["travel"]["factor"], 1.0)

    def test_auto_shortens_a_fast_motion(self):
        self.run_walk("whole.csv", *FAST)
        self.run_walk("less.csv", *FAST, "--travel", "auto", "--report", "less.json")
        travel = self.report("less.json")["travel"]
        self.assertLess(travel["factor"], 0.95)
        self.assertGreaterEqual(travel["least"], 0.85)
        self.assertAlmostEqual(self.way("less.csv") / self.way("whole.csv"), travel["factor"],
                               delta=0.02)

    def test_without_it_reports_and_sidecars_do_not_name_it(self):
        self.run_walk("out.csv", "--end", "1", "--sidecar", "--report", "out.json")
        for name in ("out.json", "out.csv.json"):
            text = (self.folder / name).read_text()
            self.assertNotIn('"travel"', text)
            self.assertNotIn('"for"', text)

    def test_wrong_values(self):
        for value in ("0.2", "2", "fast", "nan"):
            result = self.retarget("--travel", value)
            self.assert_fails(result, 2, "--travel", "a number from 0.5 to 1.2 or `auto`")
        self.assert_fails(self.retarget("--travel", "0.9", "--method", "gmr"), 2,
                          "--for and --travel require --method fit")

    def test_live_refuses_it(self):
        for option in (("--travel", "0.9"), ("--for", "tracking")):
            result = self.run_tool("live", "--play", sample("wave"), "--robot", "g1", *option)
            self.assert_fails(result, 2, option[0])


class Measuring(TravelTest):
    def evaluate(self, *arguments):
        self.run_tool("evaluate", *arguments, "--robot", "g1", "--bvh", sample("walk"), "--json",
                      "measured.json")
        return self.report("measured.json")

    def test_evaluate_takes_the_factor_from_the_sidecar_or_an_option(self):
        self.run_walk("fast.csv", *FAST, "--travel", "auto", "--sidecar", "--report", "run.json")
        wanted = self.report("run.json")
        self.assertTrue(wanted["passed"])
        for extra in ((), ("--travel", "auto")):
            found = self.evaluate("fast.csv", *FAST, *extra)
            self.assertEqual(found["travel"], wanted["travel"])
            for key in ("root_slide_mean", "lag_s", "stance_slip_mean", "stance_drift_p95_cm"):
                self.assertAlmostEqual(found[key], wanted[key], delta=1e-9)
            self.assertTrue(found["passed"])
        # Without the sidecar the path is compared with the unscaled one.
        (self.folder / "fast.csv.json").unlink()
        unscaled = self.evaluate("fast.csv", *FAST)
        self.assertNotIn("travel", unscaled)
        self.assertGreater(unscaled["root_slide_mean"], 2.0 * wanted["root_slide_mean"])

    def test_sidecars_that_disagree(self):
        self.run_walk("a.csv", "--end", "2", "--travel", "0.9", "--sidecar")
        self.run_walk("b.csv", "--end", "2", "--sidecar")
        result = self.run_tool("evaluate", "a.csv", "b.csv", "--robot", "g1", "--bvh",
                               sample("walk"), "--gate", "none")
        self.assert_done(result)
        self.assertIn("different travel", result.stderr)


class Preset(TravelTest):
    def test_it_is_recorded_and_verified(self):
        self.run_walk("out.csv", "--for", "tracking", "--frames", "30:90", "--sidecar")
        sidecar = json.loads((self.folder / "out.csv.json").read_text())
        self.assertEqual(sidecar["options"]["for"], "tracking")
        self.assertNotIn("travel", sidecar["options"])
        self.assertEqual(sidecar["quality"]["motions"][0]["travel"], sidecar["found"]["travel"])
        self.assert_done(self.run_tool("verify", "out.csv.json"))

    def test_given_options_win(self):
        fast = (*FAST, "--frames", "60:120")
        preset = self.run_walk("a.csv", *fast, "--for", "tracking")
        without = self.run_walk("b.csv", *fast, "--for", "tracking", "--without", "dynamics",
                                "--travel", "1")
        self.assertNotEqual(preset, without)
        smoother = {f"smoothness_{part}": 2 * weight
                    for part, weight in (("leg", 1.75), ("arm", 2.15), ("wrist", 1.65))}
        root = {"smoothness_root_position": 40.0, "smoothness_root_reference": 0.0,
                "smoothness_root_rotation": 8.0, "limb_smoothing_time": 0.0}
        self.write("fit.json", json.dumps({**smoother, **root}))
        self.assertEqual(self.run_walk("c.csv", *fast, "--fit-config", "fit.json", "--without",
                                       "dynamics"), without)
        self.assertEqual(self.run_walk("d.csv", *fast, "--fit-config", "fit.json", "--travel",
                                       "auto"), preset)

    def test_unknown_presets(self):
        self.assert_fails(self.retarget("--for", "trackin"), 2, 'did you mean "tracking"')
        self.assert_fails(self.retarget("--for", "tracking", "--method", "gmr"), 2,
                          "require --method fit")

    def test_a_batch_gives_the_bytes_of_a_run(self):
        clips = self.folder / "clips"
        clips.mkdir()
        for name in ("walk", "wave"):
            (clips / f"{name}.bvh").write_bytes(sample(name).read_bytes())
        self.assert_done(self.run_tool("batch", "clips", "-o", "out", "--robot", "unitree_g1",
                                       "--for", "tracking", "--jobs", "2"))
        options = json.loads((self.folder / "out" / "options.json").read_text())[0]
        self.assertEqual(options["options"]["for"], "tracking")
        self.assertTrue(options["fit"]["dynamics"])
        alone = self.run_walk("walk.csv", "--for", "tracking")
        self.assertEqual((self.folder / "out" / "walk.csv").read_bytes(), alone)


if __name__ == "__main__":
    unittest.main()
