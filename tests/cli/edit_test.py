"""`retarget edit`: BVH in, BVH out."""

import os
import pathlib
import unittest

from tool import SOURCE, ToolTest, difference, read_rows, sample

SHARED = pathlib.Path(os.environ.get("RETARGET_SHARED") or SOURCE.parent / "shared")


class Edit(ToolTest):
    def robot_rows(self, bvh, *options):
        result = self.retarget("--precision", 9, *options, bvh=bvh, output="-")
        self.assert_done(result)
        return read_rows(result.stdout)

    def edited(self, *arguments):
        result = self.run_tool("edit", *arguments, "-o", "edited.bvh")
        self.assert_done(result)
        return self.folder / "edited.bvh"

    def test_what_changes_nothing_gives_the_same_robot_motion(self):
        expected = self.robot_rows(sample("walk"))
        for arguments in (("rest", sample("walk"), "--like", sample("wave")),
                          ("transfer", sample("walk"), "--to", sample("squat")),
                          ("lafan", sample("walk"))):
            with self.subTest(edit=arguments[0]):
                self.assertIsNone(
                    difference(self.robot_rows(self.edited(*arguments)), expected, 1e-6))

    def test_faults_are_explained(self):
        walk = sample("walk")
        self.assert_fails(self.run_tool("edit", "rest", walk, "-o", "x.bvh"), 2, "--like")
        self.assert_fails(self.run_tool("edit", "lafan", walk), 2, "--output")
        self.assert_fails(self.run_tool("edit", walk), 2)
        self.assert_fails(self.run_tool("edit", "lafan", "no.bvh", "-o", "x.bvh"), 3, "no.bvh")
        self.assert_fails(self.run_tool("edit", "lafan", walk, "-o", "no/x.bvh"), 2, "no")
        self.assertEqual(self.files(), [])

    @unittest.skipUnless((SHARED / "data").is_dir(), "the shared data is not there")
    def test_other_skeletons(self):
        dialects = SHARED / "data/dialects"
        source = dialects / "games105_walk60.bvh"
        shaped = self.edited("lafan", source)
        self.assertIn("JOINT Spine2", shaped.read_text())
        self.assertEqual(len(self.robot_rows(shaped)), len(self.robot_rows(source)))
        self.edited("transfer", sample("walk"), "--to", source)
        # a run in an A-pose skeleton goes to the T-pose one of the same bones
        result = self.run_tool("edit", "rest", dialects / "games105_run_forward.bvh", "--like",
                               source, "-o", "t.bvh")
        self.assert_done(result)


if __name__ == "__main__":
    unittest.main()
