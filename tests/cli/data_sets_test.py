"""retarget batch for data sets: gates, lists of what passed, splits, parts, mirror images, duplicates."""

import json
import re
import signal
import subprocess
import time
import unittest

from batch_runs import BatchTest
from tool import TOOL, sample, short_clip

GMR = ("--method", "gmr")


class DataSetTest(BatchTest):
    def rows(self, name, folder="out"):
        return [line.split("\t") for line in self.lines(name, folder)]

    def forget_signatures(self, folder):
        """Makes the folder's manifest one of an older version, which has no signatures."""
        lines = self.manifest(f"{folder}/manifest.jsonl")
        self.assertTrue(all(line.pop("signature") for line in lines))
        self.write(f"{folder}/manifest.jsonl", "".join(json.dumps(line) + "\n" for line in lines))

    def measured(self, *arguments, **options):
        return self.batch(*GMR, *arguments, fast=False, **options)


class Gates(DataSetTest):
    def test_lists_name_passed_and_failed_motions(self):
        self.clips("b.bvh", "sub/a.bvh")
        self.write("in/bad.bvh", "HIERARCHY\n")
        result = self.measured("--gate", "none", "--gate", "peak_speed<=0", "--sidecar")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(self.lines("passed.txt"), [])
        header, *rows = self.rows("failed.tsv")
        self.assertEqual(header, ["file", "reason", "robot"])
        self.assertEqual([row[0] for row in rows], ["b.bvh", "bad.bvh", "sub/a.bvh"])
        self.assertRegex(rows[0][1], r"^peak_speed \d.* \(at most 0\)$")
        self.assertIn("bad.bvh:2:1: error", rows[1][1])
        self.assertIn("0 of 3 clips in out/passed.txt; 2 miss a gate; 1 failed", result.stderr)
        # Other gates need no work: no clip is redone.
        self.assertEqual(self.measured("--gate", "none", "--resume", "--sidecar").returncode, 1)
        self.assertEqual(self.lines("passed.txt"), ["b.csv", "sub/a.csv"])
        self.assertEqual(len(self.rows("failed.tsv")), 2)
        before = {e["relative"]: e["finished"] for e in self.manifest()}
        merged = self.run_tool("batch", "--merge", "-o", "out", "--gate", "jumps>=1", "-q")
        self.assertEqual(merged.returncode, 1)
        self.assertEqual(self.lines("passed.txt"), [])
        after = {e["relative"]: e["finished"] for e in self.manifest()}
        self.assertEqual(before, after)

    def test_lists_contain_motions_only(self):
        self.clips("a.bvh", "sub/b.bvh", frames=20)
        self.assert_done(self.batch("--gate", "none", "--contacts", "--sidecar", "--format",
                                    "pkl-gmr,csv-sonic", "--split", "0.5:1", fast=False))
        motions = ["a.gmr.pkl", "a.sonic", "sub/b.gmr.pkl", "sub/b.sonic"]
        self.assertEqual(self.lines("passed.txt"), motions)
        self.assertEqual(sorted(self.lines("train.txt") + self.lines("validation.txt")), motions)
        for motion in motions:
            self.assert_done(self.run_tool("evaluate", self.folder / "out" / motion, "--robot", "g1",
                                           "--gate", "none"))

    def test_a_missed_gate_fails_no_clip_of_a_batch(self):
        self.clips("a.bvh")
        self.assert_done(self.measured("--gate", "peak_speed<=0"))
        entry = self.manifest()[0]
        self.assertIn("peak_speed", entry["quality"]["gates_missed"])
        self.assertEqual(entry["quality"]["bounds"]["peak_speed"], {"max": 0.0})
        options = json.loads((self.folder / "out/options.json").read_text())
        self.assertEqual(options[0]["gates"]["peak_speed"], {"max": 0.0})

    def test_lists_contain_the_clips_of_the_current_call(self):
        self.clips("a.bvh", "get_up.bvh")
        self.assert_done(self.batch("--mirror"))
        self.assertEqual(len(self.lines("passed.txt")), 4)
        again = self.batch("--resume", "--exclude", "get_up*", "--split", "0.5:1")
        self.assert_done(again)
        self.assertEqual(self.lines("passed.txt"), ["a.csv"])
        self.assertEqual(self.lines("train.txt") + self.lines("validation.txt"), ["a.csv"])
        self.assertIn("3 clips of the manifest are not part of this call", again.stderr)
        # Nothing is lost.
        self.assertEqual(len(self.manifest()), 4)
        self.assertIn("4 of 4 are done", self.batch("--resume", "--mirror").stderr)
        self.assertEqual(len(self.lines("passed.txt")), 4)

    def test_options_json_has_the_gates_of_the_last_call(self):
        self.clips("a.bvh")
        self.assert_done(self.measured("--gate", "jumps<=3"))
        def gates():
            return json.loads((self.folder / "out/options.json").read_text())[0]["gates"]
        self.assertEqual(gates()["jumps"], {"max": 3.0})
        # The gates of configs/quality/default.json.
        self.assertEqual(gates()["stance_slip_mean"], {"max": 0.002, "leg_m": 0.632})
        self.assert_done(self.run_tool("batch", "--merge", "-o", "out", "--gate", "none", "--gate",
                                       "jumps<=5"))
        self.assertEqual(gates(), {"jumps": {"max": 5.0}})

    def test_merge_rejects_clip_options(self):
        self.clips("a.bvh")
        self.assert_done(self.batch())
        for option in (["--clips", "x.csv"], ["--mirror"], ["--exclude", "a*"], ["--shard", "1/2"],
                       ["--resume"], ["--redo"]):
            self.assert_fails(self.run_tool("batch", "--merge", "-o", "out", *option), 2,
                              f"{option[0]} and --merge cannot be combined")
        merged = self.run_tool("batch", "--merge", "-o", "out", "--dedupe")
        self.assert_done(merged)
        self.assertNotIn("no signature", merged.stderr)
        self.forget_signatures("out")
        merged = self.run_tool("batch", "--merge", "-o", "out", "--dedupe")
        self.assert_done(merged)
        self.assertIn("1 clip has no signature", merged.stderr)

    def test_evaluate_measures_the_variant_that_a_motion_is_of(self):
        clip = self.write("wave.bvh", short_clip("wave", 12))
        self.assert_done(self.retarget(*GMR, "--dof", "23", "--sidecar", bvh=clip))
        def report(*arguments):
            result = self.run_tool("evaluate", "out.csv", "--robot", "g1", "--bvh", clip, "--gate",
                                   "none", "--json", "report.json", *arguments)
            self.assert_done(result)
            return json.loads((self.folder / "report.json").read_text())
        by_sidecar = report()
        self.assertEqual(report("--dof", "23"), by_sidecar)
        (self.folder / "out.csv.json").unlink()
        self.assertEqual(report("--dof", "23"), by_sidecar)

    def test_single_run_accepts_gates(self):
        clip = self.write("wave.bvh", short_clip("wave", 4))
        result = self.retarget(*GMR, "--gate", "none", "--gate", "peak_speed<=0", bvh=clip)
        self.assert_fails(result, 1, "out.csv: error: the motion misses a gate: peak_speed",
                          "(at most 0)")
        self.assertTrue((self.folder / "out.csv").exists())
        self.assert_done(self.retarget(*GMR, "--gate", "none", "--gate", "peak_speed<=1000",
                                       bvh=clip))
        # Without the option, quality has no effect.
        self.assert_done(self.retarget(*GMR, bvh=clip))
        self.assert_fails(self.retarget(*GMR, "--gate", "peek_speed<=1", bvh=clip), 2,
                          'did you mean "peak_speed"?')
        gates = self.write("gates.json", '{"gates": {"jumps": 0}}')
        self.assert_fails(self.retarget(*GMR, "--gate", gates, "--report", gates, bvh=clip), 2,
                          "gates.json")
        view = self.run_tool("view", "out.csv", "--robot", "g1", "--gate", "none", "--gate",
                             "peak_speed<=0", "-o", "page.html")
        self.assert_done(view)

    def test_wrong_calls(self):
        self.clips("a.bvh")
        for arguments, words in ((("--gate", "jmps<=0"), 'did you mean "jumps"?'),
                                 (("--split", "2"), "RATIO:SEED"),
                                 (("--split", "half:1"), '"half:1"')):
            self.assert_fails(self.batch(*arguments, fast=False), 2, words)
        self.assert_fails(self.batch("--gate", "jumps<=0"), 2, "--gate and --no-quality")
        self.assert_fails(self.batch("--clips", "x.csv", "--start", "1"), 2, "--clips and --start")
        self.assert_fails(self.batch("--clips", "missing.csv"), 3, "missing.csv")
        self.assertFalse((self.folder / "out").exists())

    def test_names_of_the_lists_are_taken(self):
        self.clips("passed.txt/a.bvh")
        self.assert_fails(self.batch(), 2, "passed.txt", "a file of the batch itself")


class Splits(DataSetTest):
    LISTS = ("train.txt", "validation.txt", "test.txt")

    def excerpt(self, name, sample_name, first, count=45):
        """Returns a part of a sample that is long enough to differ from all other parts."""
        lines = sample(sample_name).read_text().splitlines()
        motion = next(i for i, line in enumerate(lines) if line.startswith("Frames:"))
        rows = lines[motion + 2 + first:motion + 2 + first + count]
        self.write(f"in/{name}", "\n".join([*lines[:motion], f"Frames: {len(rows)}",
                                            lines[motion + 1], *rows]) + "\n")

    def different_clips(self, *names):
        """Clips of different recordings: no two show the same movement."""
        parts = [(each, first) for each in ("walk", "get_up", "squat", "wave") for first in (0, 60)]
        for name, (each, first) in zip(names, parts, strict=False):
            self.excerpt(name, each, first)

    def side_of(self, name, folder="out"):
        """Returns the list that contains a motion."""
        lists = [each for each in self.LISTS
                 if (self.folder / folder / each).exists() and name in self.lines(each, folder)]
        self.assertEqual(len(lists), 1, (name, lists))
        return lists[0]

    def assert_together(self, *names, folder="out"):
        self.assertEqual(len({self.side_of(name, folder) for name in names}), 1, names)

    def test_subjects_stay_together_whatever_the_order(self):
        for subject in range(1, 6):
            for name in ("walk", "run"):
                self.write(f"in/{name}/{name}1_subject{subject}.bvh",
                           short_clip("wave", 1 + subject))
        result = self.batch("--split", "0.8:7", "--jobs", 3)
        self.assert_done(result)
        train, validation = self.lines("train.txt"), self.lines("validation.txt")
        self.assertEqual((len(train), len(validation)), (8, 2))
        subjects = [{re.search(r"subject(\d)", name)[1] for name in names}
                    for names in (train, validation)]
        self.assertFalse(subjects[0] & subjects[1])
        self.assertEqual(sorted(train + validation), self.lines("passed.txt"))
        self.assertIn("8 clips of 4 groups for training, 2 clips of 1 group for validation",
                      result.stderr)
        self.assertIn("5 groups by the subject", result.stderr)
        # The same in parts that are merged.
        for part in (1, 2, 3):
            part_done = self.batch("--split", "0.8:7", "--shard", f"{part}/3", output="parts")
            self.assert_done(part_done)
            self.assertIn("written when the parts are merged", part_done.stderr)
            self.assertFalse((self.folder / "parts/train.txt").exists())
        self.assert_done(self.run_tool("batch", "--merge", "-o", "parts", "--split", "0.8:7"))
        for name in ("train.txt", "validation.txt", "passed.txt"):
            self.assertEqual(self.lines(name, "parts"), self.lines(name))
        # Without the option the lists are outdated, which is a warning.
        again = self.batch("--resume")
        self.assertIn("train.txt: warning: this list is from an earlier call", again.stderr)

    def test_copies_of_an_input_are_on_one_side(self):
        names = [f"walk1_subject{subject}.bvh" for subject in range(1, 7)]
        self.different_clips(*names)
        copy = (self.folder / "in/walk1_subject1.bvh").read_bytes()
        others = ("copies/b.bvh", "copies/walk2_subject2.bvh", "zz.bvh")
        for name in others:
            self.write(f"in/{name}", copy)
        together = [name.replace(".bvh", ".csv")
                    for name in (*others, "walk1_subject1.bvh", "walk1_subject2.bvh")]
        for seed in range(6):
            result = self.batch("--split", f"0.6:{seed}", "--resume")
            self.assert_done(result)
            self.assert_together(*together)
            self.assertIn("3 groups joined with others", result.stderr)
            self.assertGreater(len(self.lines("validation.txt")), 0)
        # The result is independent of the order of inputs, shards, resume and merges.
        whole = {name: self.lines(name) for name in ("train.txt", "validation.txt")}
        files = sorted(str(file) for file in (self.folder / "in").rglob("*.bvh"))
        self.assert_done(self.batch("--split", "0.6:5", "--relative-to", self.folder / "in",
                                    inputs=reversed(files), output="reversed"))
        for part in (2, 1):
            self.assert_done(self.batch("--shard", f"{part}/2", output="parts"))
        self.assert_done(self.run_tool("batch", "--merge", "-o", "parts", "--split", "0.6:5"))
        for name, lines in whole.items():
            self.assertEqual(self.lines(name, "reversed"), lines)
            self.assertEqual(self.lines(name, "parts"), lines)

    def test_copies_are_on_one_side_with_dedupe_as_well(self):
        self.different_clips("a.bvh", "b.bvh", "c.bvh", "d.bvh")
        self.write("in/e.bvh", (self.folder / "in/a.bvh").read_bytes())
        self.assert_done(self.batch("--mirror"))
        self.assert_done(self.batch("--mirror", "--dedupe", "--split", "0.5:1", "--resume"))
        self.assert_together("a.csv", "a_mirrored.csv")
        self.assertNotIn("e.csv", self.lines("passed.txt"))
        for seed in range(4):
            self.assert_done(self.batch("--mirror", "--split", f"0.5:{seed}", "--resume"))
            self.assert_together("a.csv", "a_mirrored.csv", "e.csv", "e_mirrored.csv")

    def test_mirror_images_are_on_one_side_whatever_their_names(self):
        self.different_clips("a.bvh", "b.bvh", "c.bvh", "d.bvh", "e.bvh", "f.bvh")
        for name, image in (("a", "other"), ("d", "zz")):
            self.assert_done(self.run_tool("edit", "mirror", f"in/{name}.bvh", "-o",
                                           f"in/{image}.bvh"))
        for seed in range(6):
            self.assert_done(self.batch("--split", f"0.6:{seed}", "--resume"))
            self.assert_together("a.csv", "other.csv")
            self.assert_together("d.csv", "zz.csv")
        self.assert_done(self.run_tool("batch", "--merge", "-o", "out", "--split", "0.6:0"))
        self.assert_together("a.csv", "other.csv")
        # Shards that ran without the option can be split when they are merged.
        for part in ("1/2", "2/2"):
            self.assert_done(self.batch("--shard", part, output="bare"))
        for seed in range(6):
            merged = self.run_tool("batch", "--merge", "-o", "bare", "--split", f"0.6:{seed}")
            self.assert_done(merged)
            self.assertNotIn("only by their names", merged.stderr)
            self.assert_together("a.csv", "other.csv", folder="bare")
            self.assert_together("d.csv", "zz.csv", folder="bare")
        # The manifest of an older version has no signatures: the merge pairs mirror images by name
        # only, and warns.
        self.forget_signatures("bare")
        merged = self.run_tool("batch", "--merge", "-o", "bare", "--split", "0.6:0")
        self.assert_done(merged)
        self.assertIn("mirror images of 8 clips are identified only by their names", merged.stderr)

    def test_parts_of_copies_are_on_one_side(self):
        self.different_clips("a.bvh", "b.bvh", "c.bvh")
        self.write("in/x/d.bvh", (self.folder / "in/a.bvh").read_bytes())
        self.write("parts.csv", "a.bvh,f0,f15,one\na.bvh,f30,f40,two\nx/d.bvh,f15,f30,three\n"
                                "b.bvh,f0,f15,b\nc.bvh,f0,f15,c\n")
        for seed in range(4):
            self.assert_done(self.batch("--clips", "parts.csv", "--mirror", "--split",
                                        f"0.6:{seed}", "--resume"))
            self.assert_together("one.csv", "two.csv", "x/three.csv", "two_mirrored.csv",
                                 "x/three_mirrored.csv")

    def test_three_shares_make_three_lists(self):
        names = [f"walk1_subject{subject}.bvh" for subject in range(1, 8)]
        self.different_clips(*names)
        result = self.batch("--split", "0.6,0.2,0.2:1")
        self.assert_done(result)
        lists = [self.lines(name) for name in self.LISTS]
        self.assertEqual([len(lines) for lines in lists], [5, 1, 1])
        self.assertEqual(sorted(sum(lists, [])), self.lines("passed.txt"))
        self.assertIn("5 clips of 5 groups for training, 1 clip of 1 group for validation, "
                      "1 clip of 1 group for testing", result.stderr)
        for part in (1, 2):
            self.assert_done(self.batch("--shard", f"{part}/2", output="parts"))
        self.assert_done(self.run_tool("batch", "--merge", "-o", "parts", "--split",
                                       "0.6,0.2,0.2:1"))
        self.assertEqual([self.lines(name, "parts") for name in self.LISTS], lists)
        # A list that a two-way split does not rewrite is outdated.
        again = self.batch("--resume", "--split", "0.8:1")
        self.assert_done(again)
        self.assertIn("test.txt: warning: this list is from an earlier call", again.stderr)

    def test_shares_add_up_to_one(self):
        self.clips("a.bvh")
        for shares in ("0.8,0.1,0.2", "0.5,0.4", "0.8,0.1,0.05:3"):
            self.assert_fails(self.batch("--split", shares), 2, "add up to", "hint", "0.8,0.1,0.1")
        self.assertFalse((self.folder / "out").exists())


class MirrorImages(DataSetTest):
    def test_mirror_images_are_as_good_as_their_originals(self):
        self.write("in/wave.bvh", short_clip("wave", 40))
        self.assert_done(self.batch("--mirror", "--sidecar", fast=False))
        self.assertEqual(self.outputs(), ["wave.csv", "wave_mirrored.csv"])
        original, image = self.manifest()
        self.assertEqual((image["source"], image["mirror_of"]), ("wave.bvh", "wave.bvh"))
        self.assertNotIn("mirror_of", original)
        for key in ("limb_angle_deg", "trunk_lean_error_deg", "track_pos_cm"):
            self.assertAlmostEqual(original["quality"]["figures"][key],
                                   image["quality"]["figures"][key], delta=0.3)
        # Left and right are exchanged.
        ours, theirs = ([[float(x) for x in line.split(",")] for line in self.lines(name)]
                        for name in ("wave.csv", "wave_mirrored.csv"))
        left, right = 7 + 15 + 3, 7 + 22 + 3  # elbows
        for a, b in zip(ours, theirs):
            self.assertAlmostEqual(a[left], b[right], delta=0.06)
            self.assertAlmostEqual(a[right], b[left], delta=0.06)
        self.assertGreater(max(abs(a[left] - a[right]) for a in ours), 0.5)
        # Equal to the result of a mirrored file, and of a single run.
        single = self.retarget("--mirror", bvh=self.folder / "in/wave.bvh")
        self.assert_done(single)
        self.assertEqual((self.folder / "out.csv").read_bytes(),
                         (self.folder / "out/wave_mirrored.csv").read_bytes())
        self.assert_done(self.run_tool("verify", "out/wave_mirrored.csv.json"))
        self.assert_done(self.run_tool("evaluate", "out/wave_mirrored.csv", "--robot", "g1", "--bvh",
                                       "in/wave.bvh", "--mirror"))
        self.assert_done(self.run_tool("view", "out", "-o", "gallery"))

    def test_resume_shards_and_collisions(self):
        self.clips("a.bvh", "b.bvh")
        self.assert_done(self.batch())
        again = self.batch("--mirror", "--resume")
        self.assert_done(again)
        self.assertIn("2 of 4 are done", again.stderr)
        self.assertIn("4 of 4 are done", self.batch("--mirror", "--resume").stderr)
        for part in (1, 2):
            self.assert_done(self.batch("--mirror", "--shard", f"{part}/2", output="parts"))
        self.assert_done(self.run_tool("batch", "--merge", "-o", "parts"))
        self.assertEqual(self.contents("parts"), self.contents())
        self.clips("a_mirrored.bvh")
        self.assert_fails(self.batch("--mirror", output="two"), 2, "a_mirrored",
                          "omit --mirror")
        self.assertFalse((self.folder / "two").exists())


class Parts(DataSetTest):
    def test_several_parts_of_a_file(self):
        self.write("in/a/wave.bvh", short_clip("wave", 40))
        self.write("in/a/rest.bvh", short_clip("wave", 2))
        self.write("parts.csv", "file,start,end,name\na/wave.bvh,f0,f10,one\nwave.bvh,0.5,1,two\n"
                                "in/a/wave.bvh,f20,,\n")
        result = self.batch("--clips", "parts.csv")
        self.assert_done(result)
        self.assertIn("3 parts of 1 file; 1 file not in the table", result.stderr)
        self.assertEqual(self.outputs(), ["a/one.csv", "a/two.csv", "a/wave_3.csv"])
        entries = {e["relative"]: e for e in self.manifest()}
        self.assertEqual(entries["a/one.bvh"]["source"], "a/wave.bvh")
        self.assertEqual(entries["a/one.bvh"]["part"], "f0:f10")
        self.assertEqual(entries["a/wave_3.bvh"]["part"], "f20:")
        self.retarget(*GMR, "--frames", "0:10", bvh=self.folder / "in/a/wave.bvh")
        self.assertEqual((self.folder / "out.csv").read_bytes(), self.contents()["a/one.csv"])
        self.retarget(*GMR, "--start", "0.5", "--end", "1", bvh=self.folder / "in/a/wave.bvh")
        self.assertEqual((self.folder / "out.csv").read_bytes(), self.contents()["a/two.csv"])
        self.assertNotIn("warnings", entries["a/one.bvh"])
        # Only the part that changed is done again.
        self.write("parts.csv", "a/wave.bvh,f0,f12,one\na/wave.bvh,0.5,1,two\na/wave.bvh,f20,,\n")
        self.assertIn("2 of 3 are done", self.batch("--clips", "parts.csv", "--resume").stderr)
        self.assertEqual(len(self.lines("a/one.csv")), 12)
        self.write("parts.csv", "a/wave.bvh,f30,f400,beyond\n")
        self.assert_done(self.batch("--clips", "parts.csv", output="beyond"))
        self.assertIn("frames 0 to 39", (self.folder / "beyond/manifest.jsonl").read_text())

    def test_table_locates_the_files(self):
        self.write("set/x/wave.bvh", short_clip("wave", 20))
        self.write("set/parts.csv", "x/wave.bvh,f0,f5,a\nx/wave.bvh,f5,f10,b\n")
        self.assert_done(self.batch("--clips", "set/parts.csv", "--mirror", inputs=()))
        self.assertEqual(self.outputs(), ["x/a.csv", "x/a_mirrored.csv", "x/b.csv",
                                          "x/b_mirrored.csv"])
        self.write("set/parts.csv", "x/wave.bvh,f0,f5,a\nx/gone.bvh,f5,f10,b\n")
        self.assert_fails(self.batch("--clips", "set/parts.csv", inputs=(), output="new"), 3,
                          'set/parts.csv:2: error: there is no file "set/x/gone.bvh"')

    def test_errors_name_the_line_and_come_first(self):
        self.clips("wave.bvh")
        for text, words in (("wave.bvh,1,2,a\nwale.bvh,1,2,b\n",
                             ("parts.csv:2: error", 'did you mean "wave.bvh"?')),
                            ("wave.bvh,f2,1,a\n", ("parts.csv:1: error", "mix a time and a frame")),
                            ("wave.bvh,1,2,a\nwave.bvh,2,3,a\n", ("parts.csv:2", "line 1"))):
            self.write("parts.csv", text)
            self.assert_fails(self.batch("--clips", "parts.csv"), 3, *words)
        self.assertFalse((self.folder / "out").exists())
        # A part outside of the clip is the error of this part alone.
        self.write("parts.csv", "wave.bvh,f0,f2,good\nwave.bvh,900,901,late\n")
        self.assertEqual(self.batch("--clips", "parts.csv").returncode, 1)
        self.assertEqual(self.lines("passed.txt"), ["good.csv"])


class Duplicates(DataSetTest):
    def prepare(self):
        self.write("in/a.bvh", sample("wave").read_bytes())
        self.write("in/other.bvh", sample("walk").read_bytes())
        for arguments in (("mirror", "in/a.bvh", "-o", "in/image.bvh"),
                          ("resample", "in/a.bvh", "--fps", "50", "-o", "in/m50.bvh"),
                          ("trim", "in/a.bvh", "--frames", "3:117", "-o", "in/trimmed.bvh")):
            self.assert_done(self.run_tool("edit", *arguments))

    def test_duplicates_are_not_solved(self):
        self.prepare()
        result = self.batch("--dedupe", "--mirror")
        self.assert_done(result)
        self.assertEqual(self.lines("passed.txt"), ["a.csv", "a_mirrored.csv", "other.csv",
                                                    "other_mirrored.csv"])
        self.assertEqual(self.outputs(), self.lines("passed.txt"))
        header, *rows = self.rows("duplicates.tsv")
        self.assertEqual(header, ["file", "of", "kind", "distance_deg", "robot"])
        kinds = {row[0]: (row[1], row[2]) for row in rows}
        self.assertEqual(kinds["image.bvh"], ("a.bvh", "mirrored"))
        for name in ("m50.bvh", "trimmed.bvh", "image_mirrored.bvh"):
            self.assertEqual(kinds[name], ("a.bvh", "same"))
        self.assertEqual(kinds["m50_mirrored.bvh"], ("a.bvh", "mirrored"))
        status = {e["relative"]: e["status"] for e in self.manifest()}
        self.assertEqual(status["image.bvh"], "duplicate")
        again = self.batch("--dedupe", "--mirror", "--resume")
        self.assert_done(again)
        self.assertIn("4 of 4 are done", again.stderr)
        # Without the option they are ordinary clips.
        self.assert_done(self.batch("--mirror", "--resume"))
        self.assertEqual(len(self.lines("passed.txt")), 10)
        # With it, they are found again among the finished ones.
        self.assert_done(self.batch("--mirror", "--resume", "--dedupe"))
        self.assertEqual(len(self.lines("passed.txt")), 4)
        self.assert_done(self.run_tool("view", "out", "-o", "gallery"))

    def test_a_duplicate_takes_the_place_of_what_is_excluded(self):
        self.prepare()
        self.assert_done(self.batch("--dedupe"))
        self.assertEqual(self.lines("passed.txt"), ["a.csv", "other.csv"])
        self.assert_done(self.batch("--dedupe", "--resume", "--exclude", "a.bvh"))
        self.assertEqual(self.lines("passed.txt"), ["image.csv", "other.csv"])

    def test_parts_of_a_batch_find_them_when_they_are_joined(self):
        self.prepare()
        for part in (1, 2, 3):
            self.assert_done(self.batch("--dedupe", "--shard", f"{part}/3"))
        self.assert_done(self.run_tool("batch", "--merge", "-o", "out", "--dedupe"))
        self.assertEqual(self.lines("passed.txt"), ["a.csv", "other.csv"])

    def test_unreadable_files_fail(self):
        self.prepare()
        self.write("in/bad.bvh", "HIERARCHY\n")
        result = self.batch("--dedupe")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual([row[0] for row in self.rows("failed.tsv")[1:]], ["bad.bvh"])
        self.assertEqual(self.lines("passed.txt"), ["a.csv", "other.csv"])

    def test_ctrl_c_leaves_a_resumable_folder(self):
        for i in range(40):
            self.write(f"in/{i}.bvh", sample("walk").read_bytes())
        process = subprocess.Popen(
            [TOOL, "batch", "in", "-o", "out", "--robot", "unitree_g1", "--dedupe", "--jobs", "1"],
            cwd=self.folder, stderr=subprocess.PIPE)
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertIn(process.returncode, (130, -signal.SIGINT, 0))
        self.assert_done(self.batch("--dedupe", "--resume"))
        self.assertEqual(len(self.lines("passed.txt")), 1)


if __name__ == "__main__":
    unittest.main()
