"""retarget batch: the clips and robots that a call selects, and inputs that have changed."""

import os
import unittest

from batch_runs import BatchTest
from tool import short_clip


class Selection(BatchTest):
    def test_lists_contain_the_robots_of_the_current_call(self):
        self.clips("a.bvh", "b.bvh")
        self.assert_done(self.batch(robot="unitree_g1,booster_t1,unitree_h1"))
        self.assertEqual(len(self.lines("passed.txt")), 6)
        again = self.batch("--resume", "--fps", "50", "--split", "0.5:1",
                           robot="unitree_g1,booster_t1")
        self.assert_done(again)
        listed = [f"{robot}/{clip}.csv" for robot in ("booster_t1", "unitree_g1") for clip in "ab"]
        self.assertEqual(self.lines("passed.txt"), listed)
        self.assertEqual(sorted(self.lines("train.txt") + self.lines("validation.txt")), listed)
        self.assertIn("2 clips of the manifest are not part of this call", again.stderr)
        self.assertIn("4 of 4 clips", again.stderr)
        self.assertEqual(len(self.manifest()), 6)

    def test_the_sidecar_of_an_input_is_part_of_it(self):
        self.write("wave.bvh", short_clip("wave", 30))
        (self.folder / "in").mkdir()
        self.assert_done(self.retarget("--method", "gmr", "--fps", "60", "--sidecar",
                                       bvh="wave.bvh", output="in/wave.csv"))
        sidecar = self.folder / "in/wave.csv.json"
        content = sidecar.read_text()

        def frames(*arguments):
            made = self.batch("--from-robot", "g1", "--fps", "30", *arguments, robot="booster_t1")
            self.assert_done(made)
            return self.manifest()[0]["frames"], "1 of 1 are done" in made.stderr

        first, _ = frames()
        self.assertEqual(frames("--resume"), (first, True))
        sidecar.unlink()  # Without it, the file is read at 30 frames per second.
        without, kept = frames("--resume")
        self.assertFalse(kept)
        self.assertGreater(without, first + 10)
        sidecar.write_text(content)
        self.assertEqual(frames("--resume"), (first, False))
        # A new modification time without a new content is not a change.
        os.utime(sidecar, (1, 1))
        self.assert_done(self.batch("--from-robot", "g1", "--fps", "30", "--resume",
                                    robot="booster_t1"))
        sidecar.write_text(content.replace('"fps": 60', '"fps": 50'))
        self.assertFalse(frames("--resume")[1])

    def test_a_pattern_that_excludes_nothing_is_a_warning(self):
        self.clips("a.bvh", "b.bvh")
        done = self.batch("--exclude", "b*", "--exclude", "*.fbx")
        self.assert_done(done)
        self.assertIn('warning: --exclude "*.fbx" matches no motion file', done.stderr)
        self.assertNotIn('"b*"', done.stderr)

    def test_a_seed_requires_variants(self):
        self.clips("a.bvh")
        self.assert_fails(self.batch("--seed", "3"), 2, "--seed requires --variants")
        self.assertFalse((self.folder / "out").exists())

    @unittest.skipIf(os.name == "nt", "Windows has no such names")
    def test_names_with_line_breaks_are_not_counted_as_listed(self):
        self.clips("a.bvh", "b\nc.bvh")
        done = self.batch("--split", "0.5:1")
        self.assert_done(done)
        self.assertEqual(self.lines("passed.txt"), ["a.csv"])
        self.assertIn("1 of 2 clips in out/passed.txt", done.stderr)
        self.assertIn("1 clip with a line break in the name cannot be listed", done.stderr)


if __name__ == "__main__":
    unittest.main()
