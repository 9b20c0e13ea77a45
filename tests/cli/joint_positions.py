"""Joint positions of motions, for tests of files that contain nothing else."""

import csv
import io
import json

from optional_numpy import numpy
from tool import ToolTest


class PositionsTest(ToolTest):
    def places_of(self, motion):
        """Names and world positions (F, J, 3) of a motion's joints, in its own unit and axes."""
        found = self.run_tool("inspect", motion, "--json")
        self.assert_done(found)
        names = [joint["name"] for joint in json.loads(found.stdout)["joints"]]
        table = self.run_tool("inspect", motion, "--positions", "-")
        self.assert_done(table)
        rows = list(csv.reader(io.StringIO(table.stdout)))
        columns = [rows[0].index(name + ".x") for name in names]
        numbers = numpy.array(rows[1:])[:, [c + axis for c in columns for axis in range(3)]]
        return names, numbers.astype(float).reshape(len(rows) - 1, len(names), 3)
