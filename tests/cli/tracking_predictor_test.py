"""The tracking predictor belongs to today's metrics and controller: its reference motions have the stored values."""

import json
import sys
import unittest

from tool import SOURCE, TOOL, ToolTest

sys.path.insert(0, str(SOURCE / "tools"))
import fit_tracking_predictor

REFIT = "fit the model again: tools/fit_tracking_predictor.py"
# Relative. The error is that of a simulation, which may differ between machines.
TOLERANCES = {"root_error_cm": 0.05}
USUAL_TOLERANCE = 0.01


class TrackingPredictor(ToolTest):
    def test_references_are_those_of_the_fit(self):
        predictor = json.loads((SOURCE / "configs/quality/tracking_predictor.json").read_text())
        today = fit_tracking_predictor.reference_values(TOOL)
        self.assertEqual(today.keys(), predictor["references"].keys())
        simulated = 0
        for name, stored in predictor["references"].items():
            self.assertEqual(today[name].keys(), stored.keys(), f"{name}; {REFIT}")
            self.assertLessEqual({figure["metric"] for figure in predictor["figures"]}, stored.keys())
            simulated += "root_error_cm" in stored
            for metric, value in stored.items():
                tolerance = TOLERANCES.get(metric, USUAL_TOLERANCE)
                self.assertAlmostEqual(today[name][metric], value, delta=tolerance * value,
                                       msg=f"{name}: {metric}; {REFIT}")
        self.assertTrue(simulated)


if __name__ == "__main__":
    unittest.main()
