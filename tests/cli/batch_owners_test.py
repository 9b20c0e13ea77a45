"""Batches and their later runs replace no file of another clip, robot or program."""

import json
import subprocess
import unittest

from batch_runs import FAST, BatchTest
from tool import TOOL, short_clip


class Owners(BatchTest):
    def test_another_robot_replaces_no_motion(self):
        self.clips("a.bvh", "sub/b.bvh")
        self.assert_done(self.batch("--sidecar"))
        before = {name: (self.folder / "out" / name).read_bytes()
                  for name in ("a.csv", "a.csv.json", "sub/b.csv", "manifest.jsonl")}
        for how in ([], ["--shard", "1/2"], ["--sidecar"]):
            self.assert_fails(self.batch("--resume", *how, robot="booster_t1"), 2, "booster_t1",
                              "unitree_g1", "another folder")
        self.assertEqual({name: (self.folder / "out" / name).read_bytes() for name in before},
                         before)
        # Several robots have folders of their own, also if the first one is done.
        self.assert_done(self.batch("--resume", "--sidecar", robot="unitree_g1,booster_t1"))
        self.assertEqual((self.folder / "out/a.csv").read_bytes(), before["a.csv"])
        self.assertEqual(len(self.manifest()), 4)
        self.assert_done(self.batch("--redo", robot="booster_t1"))

    def test_a_file_with_the_same_stem_replaces_no_motion_of_another(self):
        self.clips("m.bvh")
        self.assert_done(self.batch("--sidecar"))
        before = (self.folder / "out/m.csv").read_bytes()
        self.clips("m.BVH", frames=3)
        self.assert_fails(self.batch("--resume", "--exclude", "m.bvh"), 2, '"m.BVH"', '"m.bvh"')
        self.assertEqual((self.folder / "out/m.csv").read_bytes(), before)
        # The clip of a deleted file gives way.
        (self.folder / "in/m.bvh").unlink()
        done = self.batch("--resume")
        self.assert_done(done)
        self.assertIn("1 file of deleted clips remains in place", done.stderr)
        self.assertIn("m.csv.json", done.stderr)
        self.assertEqual([entry["relative"] for entry in self.manifest()], ["m.BVH"])

    def test_clips_of_another_working_directory_are_not_deleted_clips(self):
        self.clips("m.bvh")
        (self.folder / "elsewhere").mkdir()
        self.assert_done(self.batch())
        before = (self.folder / "out/m.csv").read_bytes()
        self.write("elsewhere/others/m.BVH", short_clip("wave", 3))
        moved = subprocess.run(
            [TOOL, "batch", "others", "-o", "../out", "--robot", "unitree_g1", "--resume", *FAST],
            cwd=self.folder / "elsewhere", capture_output=True, text=True, timeout=60,
            env=self.tool_environment(), check=False)
        self.assert_fails(moved, 2, '"m.BVH"', '"m.bvh"')
        self.assertEqual((self.folder / "out/m.csv").read_bytes(), before)

    def test_merging_lists_an_output_once(self):
        self.clips("m.bvh")
        self.assert_done(self.batch())
        older = (self.folder / "out/manifest.jsonl").read_text()
        (self.folder / "in/m.bvh").rename(self.folder / "in/m.BVH")
        self.assert_done(self.batch("--resume"))
        self.write("older.jsonl", older)
        merged = self.run_tool("batch", "--merge", "-o", "out", "older.jsonl")
        self.assert_done(merged)
        self.assertIn('1 clip dropped, because another clip has replaced the output: "m.csv"',
                      merged.stderr)
        self.assertEqual([entry["relative"] for entry in self.manifest()], ["m.BVH"])
        self.assertEqual(self.lines("passed.txt"), ["m.csv"])

    def test_a_new_batch_replaces_no_foreign_file(self):
        self.clips("a.bvh", "b.bvh")
        for name, text in (("out/b.csv", "mine"), ("precious.txt", "precious")):
            self.write(name, text)
        (self.folder / "out/a.csv").symlink_to("../precious.txt")
        for how in ([], ["--resume"], ["--redo"]):
            failed = self.batch(*how)
            self.assert_fails(failed, 2, "would write through 1 link", "a.csv", "remove the link")
            self.assertNotIn("--redo", failed.stderr)
        self.assertEqual((self.folder / "precious.txt").read_text(), "precious")
        (self.folder / "out/a.csv").unlink()
        self.write("out/a.csv", "mine")
        for how in ([], ["--resume"]):
            self.assert_fails(self.batch(*how), 2, "would replace 2 files", "a.csv, b.csv",
                              "--redo")
        self.assertEqual((self.folder / "out/b.csv").read_text(), "mine")
        self.assertEqual(list((self.folder / "out").glob("manifest*")), [])
        for name in ("a.csv", "b.csv"):
            (self.folder / "out" / name).unlink()
        self.write("out/summary.csv", "mine")
        self.assert_fails(self.batch(), 2, "would replace 1 file of", "summary.csv")
        self.assert_fails(self.batch("--shard", "1/2"), 2, "would replace 1 file", "summary.csv")
        self.assert_done(self.batch("--redo"))

    def test_a_part_replaces_the_files_of_other_parts_and_of_no_one_else(self):
        self.clips("a.bvh", "b.bvh")
        self.write("out/options.json", "mine")
        for how in ([], ["--resume"]):
            self.assert_fails(self.batch("--shard", "1/2", *how), 2, "options.json")
        self.assertEqual((self.folder / "out/options.json").read_text(), "mine")
        (self.folder / "out/options.json").unlink()
        for number in (1, 2):
            self.assert_done(self.batch("--shard", f"{number}/2"))


if __name__ == "__main__":
    unittest.main()
