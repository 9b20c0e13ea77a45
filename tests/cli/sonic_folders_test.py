"""Folders of CSVs, as SONIC's deployment reads them, are motions like any file."""

import unittest

from motion_formats import GOLDEN, FormatsTest

TOLERANCE = 2e-6
G1 = ("--robot", "unitree_g1")


class Folders(FormatsTest):
    def test_variants_are_read_back(self):
        for variant in ("27", "23", "23-pbhc"):
            with self.subTest(variant=variant):
                for name, form in (("folder", "csv-sonic"), ("mjlab.npz", "npz-mjlab")):
                    self.converted(GOLDEN / "walk.csv", f"{variant}.{name}", "--dof", variant,
                                   "--format", form)
                source = f"{variant}.folder"
                given = ("--source-dof", variant)
                self.converted(source, "a.csv", *given)
                self.converted(f"{variant}.mjlab.npz", "b.csv", *given)
                # An NPZ ends one frame earlier.
                rows = self.rows("a.csv")
                self.assert_same(rows[:len(self.rows("b.csv"))], self.rows("b.csv"), TOLERANCE)
                self.converted(source, "again", *given, "--dof", variant, "--format", "csv-sonic")
                self.assertEqual((self.folder / "again/joint_pos.csv").read_bytes(),
                                 (self.folder / source / "joint_pos.csv").read_bytes())
                self.assert_done(self.run_tool("evaluate", source, *G1, "--dof", variant))
        self.assertIn("2 of the robot's 29 joints are not in the file",
                      self.converted("27.folder", "a.csv"))
        self.assert_fails(self.convert("23.folder", "x.csv"), 3, "23, 23-pbhc", "--source-dof")
        self.assert_fails(self.convert("23.folder", "x.csv", "--source-dof", "27"), 3, "23 joints")
        # The bodies of another variant with equally many joints are elsewhere.
        self.assert_fails(self.convert("23.folder", "x.csv", "--source-dof", "23-pbhc"), 3,
                          "forward kinematics")

    def test_view_shows_a_motion(self):
        self.converted(GOLDEN / "walk.csv", "walk", "--format", "csv-sonic")
        for output in ("walk.html", "walk.svg"):
            self.assert_done(self.run_tool("view", "walk", *G1, "-o", output))
        # Two motions of one page; a folder without a motion is a batch.
        self.assert_done(self.run_tool("view", "walk", GOLDEN / "walk.csv", *G1, "-o", "two.html"))
        (self.folder / "walk/body_quat.csv").unlink()
        self.assert_fails(self.run_tool("view", "walk", *G1, "-o", "x.html"), 2, "gallery")


if __name__ == "__main__":
    unittest.main()
