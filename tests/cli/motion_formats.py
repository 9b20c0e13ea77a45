"""Support for tests of robot motion files: every format, conversions, comparisons."""

import pickle

from optional_numpy import numpy as np
from tool import SOURCE, ToolTest, difference

GOLDEN = SOURCE / "tests" / "golden"
FORMATS = {"csv": "out.csv", "csv-soma": "out.soma.csv", "npz-mjlab": "out.mjlab.npz",
           "npz-beyondmimic": "out.beyondmimic.npz", "pkl-gmr": "out.gmr.pkl",
           "pkl-pbhc": "out.pbhc.pkl", "npz-holosoma": "out.holosoma.npz",
           "pkl-motion-lib": "out.motion-lib.pkl", "pkl-mimickit": "out.mimickit.pkl",
           "protomotions": "out.motion"}


class FormatsTest(ToolTest):
    def setUp(self):
        super().setUp()
        if np is None:
            self.skipTest("no numpy")

    def convert(self, source, output, *arguments, robot="unitree_g1"):
        return self.run_tool("convert", source, output, "--robot", robot, *arguments)

    def converted(self, source, output, *arguments):
        result = self.convert(source, output, *arguments)
        self.assert_done(result)
        return result.stderr

    def load(self, name):
        with open(self.folder / name, "rb") as file:
            return pickle.load(file)

    def assert_same(self, found, expected, tolerance):
        self.assertIsNone(difference(found, expected, tolerance))
