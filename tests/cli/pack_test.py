"""retarget batch --pack: the motions that passed in one NPZ, as numpy reads it."""

import json
import unittest

from batch_runs import BatchTest
from optional_numpy import numpy as np
from tool import short_clip

NPZ = ("--format", "npz-mjlab", "--pack", "motions.npz")
FRAMES = {"b": 9, "a": 14, "sub/c": 6, "ä": 11}
ALONG_TIME = ("joint_pos", "joint_vel", "body_pos_w", "body_quat_w", "body_lin_vel_w",
              "body_ang_vel_w")


@unittest.skipIf(np is None, "numpy is missing")
class Packs(BatchTest):
    def motions(self):
        for name, frames in FRAMES.items():
            self.write(f"in/{name}.bvh", short_clip("walk" if name == "b" else "wave", frames))

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def assert_holds(self, packed, names, folder="out"):
        """Every clip's slice equals its own file, and the pack has no other contents."""
        with np.load(self.folder / packed, allow_pickle=False) as motions:
            arrays = dict(motions)
        self.assertEqual(arrays["clip_names"].tolist(), names)
        starts, lengths = arrays["clip_starts"], arrays["clip_lengths"]
        self.assertEqual((starts.dtype, lengths.dtype), (np.int64, np.int64))
        self.assertEqual(starts.tolist(), [0, *np.cumsum(lengths)[:-1].tolist()])
        for name, start, length in zip(names, starts, lengths):
            with np.load(self.folder / folder / f"{name}.npz") as own:
                self.assertEqual(list(arrays), [*own, "clip_names", "clip_starts", "clip_lengths"])
                for key in own:
                    part = arrays[key]
                    if key in ALONG_TIME or key == "contacts":
                        self.assertEqual(len(part), lengths.sum())
                        part = part[start:start + length]
                    self.assertEqual(part.dtype, own[key].dtype, key)
                    self.assertTrue(np.array_equal(part, own[key]), f"{name}: {key}")
        return arrays

    def test_slices_are_the_files_in_order(self):
        self.motions()
        self.write("in/bad.bvh", "HIERARCHY\n")
        result = self.batch(*NPZ, "--jobs", 2)
        self.assertEqual(result.returncode, 1, result.stderr)
        names = ["a", "b", "sub/c", "ä"]
        arrays = self.assert_holds("out/motions.npz", names)
        self.assertIn(f"out/motions.npz: 4 clips, {len(arrays['joint_pos'])} frames", result.stderr)
        # Independent of the number of processes, also if nothing remains to be done.
        self.batch(*NPZ, "--jobs", 1, output="one")
        self.assertEqual(self.bytes_of("one/motions.npz"), self.bytes_of("out/motions.npz"))
        (self.folder / "one/motions.npz").unlink()
        self.batch(*NPZ, "--resume", output="one")
        self.assertEqual(self.bytes_of("one/motions.npz"), self.bytes_of("out/motions.npz"))
        # Reading the pack as one motion is an error.
        self.assert_fails(self.run_tool("convert", "out/motions.npz", "x.csv", "--robot", "g1"), 3,
                          "contains many clips")

    def test_contacts_go_along(self):
        self.motions()
        self.assert_done(self.batch("--no-quality", "--frames", "0:6", *NPZ, fast=False))
        arrays = self.assert_holds("out/motions.npz", ["a", "b", "sub/c", "ä"])
        self.assertEqual(arrays["contacts"].shape, (len(arrays["joint_pos"]), 4))

    def test_shards_are_packed_when_they_are_merged(self):
        self.motions()
        self.assert_done(self.batch(*NPZ))
        for part in (1, 2, 3):
            self.assert_done(self.batch(*NPZ, "--shard", f"{part}/3", output="parts"))
        self.assertFalse((self.folder / "parts/motions.npz").exists())
        self.assert_done(self.run_tool("batch", "--merge", "-o", "parts", "--pack", "motions.npz"))
        self.assertEqual(self.bytes_of("parts/motions.npz"), self.bytes_of("out/motions.npz"))

    def test_only_passed_clips(self):
        self.motions()
        self.assert_done(self.batch("--method", "gmr", *NPZ, "--gate", "none", fast=False))
        speeds = {entry["relative"][:-4]: entry["quality"]["figures"]["peak_speed"]
                  for entry in self.manifest()}
        fastest = max(speeds, key=speeds.get)
        limit = sorted(speeds.values())[-2]
        self.assertLess(limit, speeds[fastest])
        merge = ("batch", "--merge", "-o", "out", "--pack", "motions.npz", "--gate", "none", "--gate")
        self.assert_done(self.run_tool(*merge, f"peak_speed<={limit}"))
        passed = (self.folder / "out/passed.txt").read_text().splitlines()
        self.assertNotIn(f"{fastest}.npz", passed)
        self.assert_holds("out/motions.npz", [name[:-4] for name in passed])
        before = self.bytes_of("out/motions.npz")
        none = self.run_tool(*merge, "peak_speed<=0")
        self.assert_done(none)
        self.assertIn("no motion passed", none.stderr)
        self.assertEqual(self.bytes_of("out/motions.npz"), before)

    def test_each_robot_has_its_own(self):
        self.motions()
        self.assert_done(self.batch(*NPZ, robot="unitree_g1,booster_t1"))
        for robot in ("unitree_g1", "booster_t1"):
            self.assert_holds(f"out/{robot}/motions.npz", ["a", "b", "sub/c", "ä"], f"out/{robot}")
        self.assertFalse((self.folder / "out/motions.npz").exists())

    def test_one_of_several_formats(self):
        self.motions()
        self.assert_fails(self.batch("--format", "npz-mjlab,npz-beyondmimic", "--pack", "x.npz"), 2,
                          "--pack", "exactly one of the formats")
        self.assert_done(self.batch("--format", "npz-mjlab,npz-beyondmimic,csv"))
        merge = ("batch", "--merge", "-o", "out", "--pack", "x.npz")
        self.assert_fails(self.run_tool(*merge), 2, "several formats", "--format")
        self.assert_done(self.run_tool(*merge, "--format", "npz-beyondmimic"))
        with np.load(self.folder / "out/x.npz") as motions:
            self.assertEqual(motions["flavour"].item(), "npz-beyondmimic")
            self.assertEqual(motions["clip_names"].tolist(), ["a", "b", "sub/c", "ä"])

    def test_files_that_do_not_fit_are_named(self):
        self.motions()
        self.assert_done(self.batch(*NPZ))
        before = self.bytes_of("out/motions.npz")
        merge = ("batch", "--merge", "-o", "out", "--pack", "motions.npz")
        own = self.bytes_of("out/b.npz")
        self.write("out/b.npz", own[:-1] + b"\1")
        self.assert_fails(self.run_tool(*merge), 3, "out/b.npz", "has changed since the batch wrote it")
        (self.folder / "out/b.npz").unlink()
        self.assert_fails(self.run_tool(*merge), 3, "out/b.npz", "no longer exists")
        # Another rate, from a merged batch.
        self.assert_done(self.batch("--format", "npz-mjlab", "--npz-fps", "25", output="slow"))
        entries = {entry["relative"]: entry for entry in self.manifest("slow/manifest.jsonl")}
        self.write("out/b.npz", self.bytes_of("slow/b.npz"))
        self.write("out/manifest.jsonl", "".join(
            json.dumps(entries["b.bvh"] if entry["relative"] == "b.bvh" else entry) + "\n"
            for entry in self.manifest()))
        self.assert_fails(self.run_tool(*merge), 3, 'out/b.npz', 'array "fps"', "25, and 50 there")
        self.assertEqual(self.bytes_of("out/motions.npz"), before)

    def test_wrong_calls(self):
        self.clips("motions.bvh", frames=8)
        for name in ("motions", "sub/motions.npz", ".npz", "../x.npz"):
            self.assert_fails(self.batch("--format", "npz-mjlab", "--pack", name), 2, "--pack")
        self.assert_fails(self.batch("--pack", "motions.npz"), 2, "--pack", "npz-mjlab")
        self.assert_fails(self.batch(*NPZ), 2, "motions.npz", "a file of the batch itself")
        self.assertFalse((self.folder / "out").exists())
        self.assert_done(self.batch("--format", "npz-mjlab"))
        own = self.bytes_of("out/motions.npz")
        self.assert_fails(self.run_tool("batch", "--merge", "-o", "out", "--pack", "motions.npz"),
                          2, "--pack", "another name")
        self.assertEqual(self.bytes_of("out/motions.npz"), own)


if __name__ == "__main__":
    unittest.main()
