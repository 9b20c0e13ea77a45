"""The engine of the browser page, run in Node, against the native tool."""

import json
import pathlib
import tempfile
import unittest

from browser_build import NODE, SOURCE, need_page, run_engine, run_native
from tool import absent, sample

EDITS = {
    "contacts": [
        {"part": "left_foot", "action": "remove", "start": 0.2, "end": 0.6},
        {"part": "right_foot", "action": "add", "start": 0.5, "end": 0.8},
    ]
}


class Engine(unittest.TestCase):
    """Runs of the engine and of the tool give the same files."""

    @classmethod
    def setUpClass(cls):
        need_page()
        if NODE is None:
            absent("there is no Node")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def compare(self, name, robot, *native, files=(), **options):
        """Solves a sample with both and compares the bytes of the CSVs."""
        expected = self.folder / "native.csv"
        done = run_native(sample(name), robot, "-o", expected, *native)
        self.assertEqual(done.returncode, 0, done.stderr)
        job = {"motion": f"/job/{name}.bvh", "robot": robot, **options}
        done = run_engine(job, self.folder / "out", sample(name), *files)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.folder / "out/motion.csv").read_bytes(), expected.read_bytes())
        return json.loads((self.folder / "out/result.json").read_text())

    def test_fit_has_the_bytes_of_the_tool(self):
        result = self.compare("walk", "unitree_g1")
        self.assertEqual(sorted(result["contacts"]), ["left_heel", "left_toe", "right_heel", "right_toe"])
        self.assertGreater(len(result["contacts"]["left_heel"]), 1)
        page = (self.folder / "out/page.html").read_text()
        self.assertIn("page-tracks", page)

    def test_published_method(self):
        self.compare("turn_in_place", "unitree_g1", "--method", "gmr", method="gmr")

    def test_every_robot(self):
        index = json.loads((SOURCE / "robots/index.json").read_text())
        names = sorted(path.parent.name for path in (SOURCE / "robots").glob("*/model.xml"))
        self.assertGreaterEqual(len(names), 16, index)
        for robot in names:
            with self.subTest(robot):
                self.compare("wave", robot, "--frames", "0:40", frames="0:40")

    def test_variant_with_its_own_model(self):
        self.compare("wave", "unitree_g1", "--dof", "23", "--frames", "0:40", dof="23", frames="0:40")

    def test_contact_edits(self):
        edits = self.folder / "edits.json"
        edits.write_text(json.dumps(EDITS))
        result = self.compare(
            "walk", "unitree_g1", "--contact-edits", edits, files=[edits], **{"contact-edits": "/job/edits.json"})
        self.assertIn("2 edits", result["summary"])

    def test_errors_are_those_of_the_tool(self):
        bad = self.folder / "bad.bvh"
        bad.write_text("HIERARCHY\nROOT Hips\n{\n  OFFSET 0 0 zero\n}\n")
        native = run_native(bad, "unitree_g1", "-o", self.folder / "native.csv")
        done = run_engine({"motion": "/job/bad.bvh", "robot": "unitree_g1"}, self.folder / "out", bad)
        self.assertEqual(done.returncode, 1)
        self.assertIn("bad.bvh:4:14", done.stderr)
        self.assertIn("bad.bvh:4:14", native.stderr)
        self.assertFalse((self.folder / "out/motion.csv").exists())

    def test_unknown_options_get_a_suggestion(self):
        done = run_engine({"motion": "/job/walk.bvh", "robot": "unitree_g1", "metod": "fit"},
                          self.folder / "out", sample("walk"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("method", done.stderr)


if __name__ == "__main__":
    unittest.main()
