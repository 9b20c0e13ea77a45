"""retarget batch --merge: missing shards, mixed options, gates, missing files, wrong options."""

import unittest

from batch_runs import BatchTest


class Merge(BatchTest):
    def merge(self, *arguments, output="out"):
        return self.run_tool("batch", "--merge", "-o", output, *arguments)

    def shards(self, *numbers, options=()):
        for number in numbers:
            self.assert_done(self.batch("--shard", f"{number}/3", "--resume", *options))

    def test_missing_shards_are_named(self):
        self.clips(*(f"{i}.bvh" for i in range(6)))
        self.shards(1, 3)
        for _ in range(2):  # The manifests stay, so that the next merge finds the gap, too.
            merged = self.merge()
            self.assertEqual(merged.returncode, 1, merged.stderr)
            self.assertIn("1 shard has no manifest: manifest.2-of-3.jsonl; process it with --shard",
                          merged.stderr)
            self.assertEqual(len(self.lines("passed.txt")), 4)
        self.shards(2)
        self.assert_done(self.merge())
        self.assertEqual(len(self.lines("passed.txt")), 6)
        self.assertEqual([name for name in self.files() if "-of-" in name], [])
        # After a complete merge, one shard may be repeated alone.
        self.shards(2, options=("--fps", "25"))
        merged = self.merge()
        self.assert_done(merged)
        self.assertNotIn("no manifest", merged.stderr)

    def test_different_options_are_a_warning(self):
        self.clips("a.bvh", "b.bvh", "c.bvh")
        self.shards(1, 2)
        self.shards(3, options=("--fps", "50"))
        merged = self.merge()
        self.assert_done(merged)
        self.assertRegex(merged.stderr, r"warning: the clips of unitree_g1 were made with 2 different "
                                        r"sets of options, such as .* (30 and 50|50 and 30) frames per")
        self.shards(1, 2, 3)
        self.assertNotIn("different sets", self.merge().stderr)

    def test_an_unmeasured_clip_misses_a_gate_that_names_a_metric(self):
        self.clips("a.bvh", "b.bvh")
        self.assert_done(self.batch())
        for gate in ("limb_angle<=0.01", "tracked_pct>=100"):
            self.assert_done(self.merge("--gate", gate))
            self.assertEqual(self.lines("passed.txt"), [], gate)
            self.assertIn(gate.split(">")[0].split("<")[0], self.lines("failed.tsv")[1])
        self.assert_done(self.merge("--gate", "default"))
        self.assertEqual(self.lines("passed.txt"), ["a.csv", "b.csv"])

    def test_a_batch_without_npz_cannot_be_packed(self):
        self.clips("a.bvh")
        self.assert_done(self.batch())
        self.assert_fails(self.merge("--pack", "m.npz"), 2, "--pack requires exactly one of the formats")
        self.assertFalse((self.folder / "out/m.npz").exists())

    def test_missing_files_are_not_listed(self):
        self.clips("a.bvh", "b.bvh")
        self.assert_done(self.batch())
        (self.folder / "out/b.csv").unlink()
        merged = self.merge("--split", "0.5:1")
        self.assert_done(merged)
        self.assertEqual(self.lines("passed.txt"), ["a.csv"])
        self.assertEqual(self.lines("train.txt") + self.lines("validation.txt"), ["a.csv"])
        self.assertIn("1 clip is not listed, because its file is missing: b.csv", merged.stderr)
        self.assertIn("1 of 2 clips", merged.stderr)
        self.assert_done(self.batch("--resume"))
        self.assert_done(self.merge())
        self.assertEqual(self.lines("passed.txt"), ["a.csv", "b.csv"])

    def test_options_without_effect_are_errors(self):
        self.clips("a.bvh")
        self.assert_done(self.batch())
        for option, *value in (("--robot", "unitree_g1"), ("--fps", "50"), ("--method", "gmr"),
                               ("--sidecar",), ("--dynamics",), ("--start", "1"), ("--jobs", "2"),
                               ("--base", "fixed"), ("--no-quality",), ("--format", "csv,npz-mjlab"),
                               ("--map", "map.json"), ("--list", "names.txt"), ("--variants", "2")):
            self.assert_fails(self.merge(option, *value), 2, f"{option} and --merge cannot be combined")
        self.assert_done(self.merge("--quiet"))


if __name__ == "__main__":
    unittest.main()
