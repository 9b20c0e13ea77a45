"""The tracking predictor belongs to today's metrics and controller: its reference motions have the stored values."""

import json
import unittest

from tool import SOURCE, ToolTest

REFIT = "fit the model again: tools/fit_tracking_predictor.py"


class TrackingPredictor(ToolTest):
    def setUp(self):
        super().setUp()
        predictor = json.loads((SOURCE / "configs/quality/tracking_predictor.json").read_text())
        self.references = predictor["references"]
        self.inputs = [figure["metric"] for figure in predictor["figures"]]

    def test_metrics_are_those_of_the_fit(self):
        for name, stored in self.references.items():
            report = self.folder / "report.json"
            self.assert_done(self.run_tool("evaluate", SOURCE / name, "--robot", "unitree_g1", "--dynamics", "--json", report,
                        "--gate", "none"))
            motion = json.loads(report.read_text())["motions"][0]
            for metric in self.inputs:
                value = motion[metric][0] if isinstance(motion[metric], list) else motion[metric]
                self.assertAlmostEqual(value, stored[metric], delta=0.01 * stored[metric] + 1e-6,
                                       msg=f"{name}: {metric}; {REFIT}")

    def test_controller_is_that_of_the_fit(self):
        simulated = {name: stored for name, stored in self.references.items() if "root_error_cm" in stored}
        self.assertTrue(simulated)
        for name, stored in simulated.items():
            report = self.folder / "report.json"
            self.assert_done(self.run_tool("simulate", SOURCE / name, "--robot", "unitree_g1", "--report", report))
            error = json.loads(report.read_text())["root_error_cm"]["mean"]
            self.assertAlmostEqual(error, stored["root_error_cm"], delta=0.05 * stored["root_error_cm"],
                                   msg=f"{name}; {REFIT}")


if __name__ == "__main__":
    unittest.main()
