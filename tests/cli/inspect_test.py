"""`retarget inspect`: the report, JSON, positions, and the verdict on every conformance file."""

import csv
import io
import json
import math
import unittest

from tool import SHARED, SOURCE, ToolTest, sample

# A root that moves and rotates, a child with a quarter turn about z, two ends.
CLIP = """HIERARCHY
ROOT Hips
{
  OFFSET 1 2 3
  CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
  JOINT "Arm, left"
  {
    OFFSET 0 10 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 5 0 0
    }
    End Site
    {
      OFFSET 0 0 2
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.008333
0 0 0 0 0 0 0 0 0
100 0 0 90 0 0 90 0 0
"""


def read_table(path):
    return csv.DictReader(io.StringIO(path.read_text(encoding="utf-8")), delimiter="\t")


class Inspect(ToolTest):
    def test_json(self):
        result = self.run_tool("inspect", "--json", self.write("clip.bvh", CLIP))
        self.assert_done(result)
        report = json.loads(result.stdout)
        self.assertEqual((report["fps"], report["frames"]), (120, 2))
        self.assertAlmostEqual(report["duration_s"], 1 / 120)
        root, arm = report["joints"]
        self.assertEqual((root["name"], root["parent"], root["offset"]), ("Hips", None, [1, 2, 3]))
        self.assertEqual(arm["name"], '"Arm, left"')
        self.assertEqual((arm["parent"], arm["parent_index"]), ("Hips", 0))
        self.assertEqual(arm["channels"], ["Zrotation", "Xrotation", "Yrotation"])
        self.assertEqual(arm["end_sites"], [[5, 0, 0], [0, 0, 2]])
        for found, expected in zip(report["extents"]["min"] + report["extents"]["max"],
                                   [0, 0, 0, 100, 10, 2]):
            self.assertAlmostEqual(found, expected)

    def test_a_body_model_is_for_smpl_motions(self):
        self.assert_fails(self.run_tool("inspect", sample("walk"), "--smpl-model", "none.npz"), 2,
                          "--smpl-model applies only to SMPL motions")

    def test_text(self):
        result = self.run_tool("inspect", sample("walk"))
        self.assert_done(result)
        for words in ("301", "30 fps", "10 s", "22", "LeftForeArm", "Zrotation Yrotation"):
            self.assertIn(words, result.stdout)
        self.assertEqual(result.stderr, "")
        about_the_human = result.stdout.split("\n\n")[0]
        self.assertIn("  human     LAFAN1", about_the_human)
        for line in about_the_human[about_the_human.index("  human"):].splitlines():
            self.assertLessEqual(len(line), 80)

    def test_positions(self):
        clip = self.write("clip.bvh", CLIP)
        self.assert_done(self.run_tool("inspect", clip, "--positions", "out.csv"))
        rows = list(csv.reader(io.StringIO((self.folder / "out.csv").read_text())))
        self.assertEqual(rows[0][:9], ["frame", "time", "Hips.x", "Hips.y", "Hips.z", "Hips.qx",
                                       "Hips.qy", "Hips.qz", "Hips.qw"])
        names = [name[:-2] for name in rows[0] if name.endswith(".x")]
        arm = '"Arm, left"'
        self.assertEqual(names, ["Hips", arm, arm + "_end", arm + "_end2"])
        last = dict(zip(rows[0], map(float, rows[2])))
        expected = {"frame": 1, "time": 1 / 120, "Hips.x": 100, "Hips.qz": math.sqrt(0.5),
                    "Hips.qw": math.sqrt(0.5), arm + ".x": 90, arm + ".y": 0, arm + ".qz": 1,
                    arm + ".qw": 0, arm + "_end.x": 85, arm + "_end.y": 0, arm + "_end2.x": 90,
                    arm + "_end2.z": 2}
        for name, value in expected.items():
            self.assertAlmostEqual(last[name], value, msg=name)
        same = self.run_tool("inspect", clip, "--positions", "-")
        self.assertEqual(same.stdout, (self.folder / "out.csv").read_text())

    def test_skeleton_alone(self):
        bones = CLIP[:CLIP.index("MOTION")]
        clip = self.write("bones.bvh", bones)
        self.assert_fails(self.run_tool("inspect", clip), 3, "bones.bvh:")
        result = self.run_tool("inspect", "--skeleton", "--json", clip)
        self.assert_done(result)
        self.assertEqual(json.loads(result.stdout)["frames"], 0)

    def test_verdict_on_every_conformance_file(self):
        folder = SOURCE / "tests/bvh/conformance"
        rows = read_table(folder / "expected.tsv")
        count = 0
        for row in rows:
            with self.subTest(file=row["file"]):
                count += 1
                result = self.run_tool("inspect", "--json", folder / (row["file"] + ".bvh"))
                if row["expect"] == "error":
                    self.assert_fails(result, 3, row["file"] + ".bvh")
                    self.assertEqual(result.stdout, "")
                    continue
                self.assert_done(result)
                report = json.loads(result.stdout)
                self.assertEqual(len(report["joints"]), int(row["joints"]))
                self.assertEqual(report["frames"], int(row["frames"]))
                self.assertEqual(report["channels"], int(row["channels"]))
                self.assertEqual("warning:" in result.stderr, row["expect"] == "ok+warn")
        self.assertEqual(count, 64)

    def test_quirks(self):
        table = SHARED / "data/quirks/README.tsv"
        if not table.exists():
            self.skipTest("no folder of shared data: set RETARGET_SHARED to run this test")
        for row in read_table(table):
            verdict = row["expected behaviour"]
            if verdict.startswith("accept") and "reject" not in verdict:
                with self.subTest(file=row["file"]):
                    self.assert_done(self.run_tool("inspect", table.parent / row["file"]))
            elif verdict.startswith("reject") and not ("accept" in verdict
                                                        or "disambiguate" in verdict):
                with self.subTest(file=row["file"]):
                    options = ["--source-fps", 30] if "source-fps" in verdict else []
                    self.assert_fails(self.run_tool("inspect", table.parent / row["file"]), 3)
                    if options:
                        self.assert_done(
                            self.run_tool("inspect", *options, table.parent / row["file"]))


if __name__ == "__main__":
    unittest.main()
