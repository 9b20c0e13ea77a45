"""`--time-scale`: slower motions, what they keep, reports, sidecars and what refuses it."""

import csv
import json
import math
import unittest

from tool import ToolTest, sample

# Three times as fast, for joints that are slower than the G1's.
FAST = ("--source-fps", "90", "--fit-config", "slow_joints.json")


class TimeScaleTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("slow_joints.json", json.dumps({"max_joint_speed": 4.0}))

    def run_sample(self, name, output, *arguments):
        self.assert_done(self.retarget("-q", *arguments, bvh=sample(name), output=output))
        return (self.folder / output).read_bytes()

    def assert_near(self, phases, wanted, part, delta=2):
        """Compares begins and ends of contacts, in frames."""
        self.assertEqual(len(phases), len(wanted), part)
        for found, expected in zip(phases, wanted):
            for frame, other in zip(found, expected):
                self.assertAlmostEqual(frame, other, delta=delta, msg=part)

    def phases(self, name):
        """The contacts in a CSV by column: their begins and ends."""
        with (self.folder / name).open() as file:
            rows = list(csv.DictReader(file))
        found = {}
        for column in list(rows[0])[2:]:
            touches = [0, *(row[column] == "1" for row in rows), 0]
            edges = [i for i in range(len(rows) + 1) if touches[i] != touches[i + 1]]
            if edges:
                found[column] = [list(pair) for pair in zip(edges[::2], edges[1::2])]
        return found


class Factor(TimeScaleTest):
    def test_a_factor_makes_the_motion_longer(self):
        self.run_sample("walk", "whole.csv", "--report", "whole.json")
        self.run_sample("walk", "slow.csv", "--time-scale", "0.5", "--report", "slow.json",
                        "--gate", "default")
        whole, slow = self.rows("whole.csv"), self.rows("slow.csv")
        self.assertAlmostEqual((len(slow) - 1) / (len(whole) - 1), 2.0, delta=0.01)
        for axis in (0, 1):
            self.assertAlmostEqual(slow[-1][axis], whole[-1][axis], delta=0.02)
        report = self.report("slow.json")
        self.assertEqual(report["fps"], 30)
        # The contacts are the same, later.
        usual = self.report("whole.json")["contacts"]
        self.assertEqual(sorted(usual), sorted(report["contacts"]))
        for part, phases in usual.items():
            later = [[2 * begin, 2 * end] for begin, end, _ in phases]
            self.assert_near([phase[:2] for phase in report["contacts"][part]], later, part)
        self.assertEqual(report["time_scale"]["least"], 0.5)
        self.assertTrue(report["passed"])

    def test_contacts_with_a_scene_are_those_of_the_source(self):
        # The left hand and elbow pass over a thin table.
        self.write("table.json", json.dumps({"bodies": [{"name": "table", "position": [0, 0.6, 0.79],
                   "shapes": [{"type": "box", "size": [20, 0.8, 0.02]}]}]}))
        reports, labels = [], []
        for factor in ("1", "0.25"):
            self.run_sample("squat", "out.csv", "--end", "5", "--scene", "table.json",
                            "--time-scale", factor, "--contacts", "contacts.csv", "--report",
                            "out.json")
            reports.append(self.report("out.json"))
            labels.append(self.phases("contacts.csv"))
        self.assertIn("left_hand:table", labels[0])
        self.assertEqual(labels[0].keys(), labels[1].keys())
        for part, phases in labels[0].items():
            later = [[4 * begin, 4 * end] for begin, end in phases]
            self.assert_near(labels[1][part], later, part, 4)
        # The metrics count the contacts of the fit.
        self.assertGreater(reports[0]["scene_contact_pct"], 20.0)
        self.assertAlmostEqual(reports[1]["scene_contact_pct"], reports[0]["scene_contact_pct"],
                               delta=3.0)
        self.assertGreater(reports[1]["scene_contact_kept_pct"], 95.0)

    def test_a_factor_of_one_has_no_effect(self):
        plain = self.run_sample("squat", "plain.csv", "--end", "2")
        self.assertEqual(self.run_sample("squat", "one.csv", "--end", "2", "--time-scale", "1"),
                         plain)

    def test_wrong_values(self):
        for value in ("0.2", "1.1", "fast", "nan", "-1"):
            result = self.retarget("--time-scale=" + value)
            self.assert_fails(result, 2, "--time-scale", "a number from 0.25 to 1 or `auto`")


class Auto(TimeScaleTest):
    def test_a_motion_within_limits_is_unchanged(self):
        # In the squat and the walk, torques exceed their limits for moments.
        for name, options in (("wave", ()), ("walk", ("--without", "dynamics"))):
            plain = self.run_sample(name, "plain.csv", *options)
            auto = self.run_sample(name, "auto.csv", *options, "--time-scale", "auto", "--report",
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

        def cut_off(report):
            return max((bound["largest"] for bound in report["fit"]["bounded"]), default=0.0)

        self.assertGreater(cut_off(fast), 0.1)  # Limits cut off the movement, rad.
        # Distortions of up to three degrees need no slower pace.
        self.assertLess(cut_off(slow), math.radians(3.0))
        scale = slow["time_scale"]
        self.assertTrue(scale["stretches"])
        self.assertIn("speed", scale["stretches"][0]["cause"])
        self.assertGreaterEqual(scale["least"], 0.25)
        self.assertLess(scale["least"], 0.95)
        self.assertGreater(slow["frames"], fast["frames"])
        self.assertAlmostEqual(scale["longer_s"], (slow["frames"] - fast["frames"]) / 30,
                               delta=0.05)
        self.assertLess(slow["limb_angle_deg"][0], fast["limb_angle_deg"][0] - 1.0)
        # The same contacts, in the same order.
        for end, phases in fast["contacts"].items():
            self.assertEqual(len(slow["contacts"][end]), len(phases), end)
        self.assert_done(self.run_tool("verify", "slow.csv.json"))

    def test_the_pace_does_not_depend_on_formats(self):
        options = (*FAST, "--time-scale", "auto", "--sidecar")
        for output, formats in (("both", "csv,npz-mjlab"), ("alone.npz", "npz-mjlab")):
            self.assert_done(self.retarget(*options, "--format", formats, output=output))
        self.assertEqual((self.folder / "both.mjlab.npz").read_bytes(),
                         (self.folder / "alone.npz").read_bytes())
        self.assertTrue(json.loads((self.folder / "both.csv.json").read_text())["found"]["time_scale"])
        for name in ("both.csv", "both.mjlab.npz"):
            self.assert_done(self.run_tool("verify", name + ".json"))

    def test_evaluate_uses_the_times_of_the_sidecar(self):
        self.run_sample("wave", "slow.csv", *FAST, "--time-scale", "auto", "--report", "run.json",
                        "--sidecar")
        wanted = self.report("run.json")

        def evaluate():
            self.run_tool("evaluate", "slow.csv", "--robot", "g1", "--bvh", sample("wave"),
                          "--source-fps", "90", "--json", "measured.json")
            return self.report("measured.json")

        found = evaluate()
        self.assertEqual(found["limb_angle_deg"], wanted["limb_angle_deg"])
        self.assertEqual(found["time_scale"], wanted["time_scale"])
        for key in ("lag_s", "root_slide_mean"):
            self.assertAlmostEqual(found[key], wanted[key], delta=1e-9)
        (self.folder / "slow.csv.json").unlink()
        other = evaluate()
        self.assertGreater(other["limb_angle_deg"][0], wanted["limb_angle_deg"][0] + 1.0)

    def test_evaluate_decides_again_without_a_sidecar(self):
        fast = ("--source-fps", "180")  # Six times as fast.
        self.run_sample("squat", "slow.csv", *fast, "--time-scale", "auto", "--report", "run.json")
        wanted = self.report("run.json")
        self.assertIn("time_scale", wanted)
        self.run_tool("evaluate", "slow.csv", "--robot", "g1", "--bvh", sample("squat"), *fast,
                      "--time-scale", "auto", "--json", "measured.json")
        self.assertEqual(self.report("measured.json")["limb_angle_deg"], wanted["limb_angle_deg"])

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
