"""retarget batch: names of outputs, handling of bad files."""

import json
import os
import unittest

from batch_runs import BatchTest
from tool import read_rows, short_clip


class Outputs(BatchTest):
    def test_tree_is_mirrored_and_bytes_are_those_of_single_runs(self):
        names = ["walk.bvh", "sub/a b/run.BVH", "sub/-dash.bvh", "läuft ünd.bvh", "-.bvh",
                 "quote ' \" $(x) *.bvh", "new\nline.bvh", "two.dots.bvh"]
        self.clips(*names)
        self.write("in/notes.txt", "no motion")
        result = self.batch()
        self.assert_done(result)
        self.assertEqual(result.stdout, "")
        self.assertEqual(self.outputs(), sorted(n[:-4] + ".csv" for n in names))
        single = self.retarget("--method", "gmr", bvh=self.folder / "in/walk.bvh")
        self.assert_done(single)
        for name, content in self.contents().items():
            self.assertEqual(content, (self.folder / "out.csv").read_bytes(), name)
        entries = self.manifest()
        self.assertEqual([e["relative"] for e in entries], sorted(names))
        for entry in entries:
            self.assertEqual((entry["status"], entry["frames"], entry["fps"]), ("done", 2, 30.0))
            self.assertTrue(entry["input"]["hash"].startswith("sha256:"))
            self.assertIn("LAFAN1", entry["taken_as"])
        self.assertFalse([f for f in self.files() if "lock" in f or "tmp" in f])

    def test_names_that_are_not_utf8(self):
        name = os.fsdecode(b"bad\xff name.bvh")
        self.clips(name)
        self.assert_done(self.batch())
        self.assertEqual(self.outputs(), [os.fsdecode(b"bad\xff name.csv")])
        self.assertEqual(bytes.fromhex(self.manifest()[0]["relative_hex"]), b"bad\xff name.bvh")
        result = self.batch("--resume")
        self.assertIn("1 of 1 are done", result.stderr)

    def test_several_robots_have_separate_folders(self):
        self.clips("a/walk.bvh")
        self.assert_done(self.batch(robot="unitree_g1,unitree_h1"))
        self.assertEqual(self.outputs(), ["unitree_g1/a/walk.csv", "unitree_h1/a/walk.csv"])
        self.assertEqual([e["robot"] for e in self.manifest()], ["unitree_g1", "unitree_h1"])

    def test_any_number_of_workers_makes_the_same_bytes(self):
        for i in range(9):
            self.clips(f"{i % 3}/{i}.bvh", frames=1 + i)
        for jobs in (1, 2, 5):
            self.assert_done(self.batch("--jobs", jobs, output=f"out{jobs}"))
            self.assertEqual(self.contents(f"out{jobs}"), self.contents("out1"))
            self.assertEqual((self.folder / f"out{jobs}/summary.csv").read_bytes(),
                             (self.folder / "out1/summary.csv").read_bytes())

    def test_little_memory_makes_the_same_bytes(self):
        self.clips("a.bvh", "b.bvh", "c.bvh")
        self.assert_done(self.batch("--jobs", 3, "--memory", "0.001"))
        self.assertEqual(len(self.outputs()), 3)

    def test_only_the_impossible_format_of_a_short_clip_is_omitted(self):
        self.write("in/long.bvh", short_clip("walk", 12))
        for frames in (1, 2):
            self.write(f"in/short{frames}.bvh", short_clip("walk", frames))
        options = ("--format", "csv,npz-mjlab,csv-sonic,protomotions", "--sidecar", "--contacts",
                   "--no-quality")
        result = self.batch(*options, fast=False)
        self.assert_done(result)
        for frames in (1, 2):
            self.assertIn(f"out/short{frames}.mjlab.npz: warning: not written: a tracking file "
                          "needs three frames at 50 fps", result.stderr)
            self.assertEqual({f for f in self.files() if f.startswith(f"out/short{frames}")},
                             {f"out/short{frames}.{end}" for end in
                              ("csv", "csv.json", "contacts.csv")})
            self.assertEqual(len((self.folder / f"out/short{frames}.csv").read_text()
                                 .splitlines()), frames)
        entry = next(e for e in self.manifest() if e["relative"] == "short1.bvh")
        self.assertEqual(entry["status"], "done")
        self.assertEqual([each["file"] for each in entry["not_written"]],
                         ["short1.mjlab.npz", "short1.sonic", "short1.motion"])
        self.assertIn("three frames", entry["not_written"][0]["reason"])
        passed = (self.folder / "out/passed.txt").read_text().splitlines()
        self.assertIn("long.mjlab.npz", passed)
        self.assertIn("short1.csv", passed)
        self.assertNotIn("short1.mjlab.npz", passed)
        again = self.batch(*options, "--resume", fast=False)
        self.assertIn("3 of 3 are done", again.stderr)
        # Files of an earlier run, in which the clip was longer, are removed.
        self.write("in/long.bvh", short_clip("walk", 1))
        self.assert_done(self.batch(*options, "--resume", fast=False))
        self.assertEqual({f for f in self.files() if f.startswith("out/long")},
                         {"out/long.csv", "out/long.csv.json", "out/long.contacts.csv"})

    def test_a_clip_too_short_for_its_only_format_fails_alone(self):
        self.write("in/long.bvh", short_clip("walk", 12))
        self.write("in/short.bvh", short_clip("walk", 1))
        result = self.batch("--format", "npz-mjlab", "--pack", "all.npz")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("three frames", result.stderr)
        self.assertEqual((self.folder / "out/passed.txt").read_text(), "long.npz\n")
        self.assertTrue((self.folder / "out/all.npz").exists())

    def test_a_pack_takes_the_clips_that_have_its_format(self):
        self.write("in/long.bvh", short_clip("walk", 12))
        self.write("in/short.bvh", short_clip("walk", 1))
        result = self.batch("--format", "csv,npz-mjlab", "--pack", "all.npz")
        self.assert_done(result)
        self.assertIn("all.npz: 1 clip,", result.stderr)

    def test_a_changed_mesh_of_the_scene_is_noticed(self):
        self.clips("a.bvh", frames=10)
        mesh = "v 0 3 0\nv 1 3 0\nv 0 4 0\nv 0 3 {}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
        self.write("step.obj", mesh.format(0.1))
        self.write("scene.json", json.dumps(
            {"bodies": [{"name": "step", "shapes": [{"type": "mesh", "file": "step.obj"}]}]}))
        options = ("--scene", "scene.json")
        self.assert_done(self.batch(*options, fast=False))
        again = self.batch(*options, "--resume", fast=False)
        self.assertIn("1 of 1 are done", again.stderr)
        self.write("step.obj", mesh.format(0.2))
        changed = self.batch(*options, "--resume", fast=False)
        self.assert_done(changed)
        self.assertNotIn("are done", changed.stderr)

    def test_base_is_no_folder(self):
        self.clips("walk.bvh", frames=4)
        for name in ("in", "fxied"):
            self.assert_fails(self.batch("--base", name, output="c"), 2, f'"{name}"', "auto", "fixed")
        self.assertFalse((self.folder / "c").exists())

    def test_the_base_of_the_robot_is_fixed_as_in_a_single_run(self):
        self.clips("walk.bvh", frames=12)
        # A folder with this name is not used.
        (self.folder / "fixed").mkdir()
        for method in ("fit", "gmr"):
            held = self.run_tool("batch", "in", "-o", method, "--robot", "g1", "--base", "fixed",
                                 "--method", method)
            self.assert_done(held)
            self.assertNotIn("warning", held.stderr)
            rows = read_rows((self.folder / method / "walk.csv").read_text())
            self.assertEqual({tuple(row[:7]) for row in rows}, {(0, 0, 0.793, 0, 0, 0, 1)})
            self.assert_done(self.retarget("--base", "fixed", "--method", method,
                                           bvh=self.folder / "in/walk.bvh"))
            self.assertEqual((self.folder / "out.csv").read_bytes(),
                             (self.folder / method / "walk.csv").read_bytes())
        # Another base changes all motions, so nothing counts as done.
        again = self.run_tool("batch", "in", "-o", "gmr", "--robot", "g1", "--method", "gmr",
                              "--base", "auto", "--resume")
        self.assert_done(again)
        rows = read_rows((self.folder / "gmr/walk.csv").read_text())
        self.assertNotEqual({tuple(row[:7]) for row in rows}, {(0, 0, 0.793, 0, 0, 0, 1)})

    def test_lists_patterns_base_and_exclude(self):
        self.clips("a/walk.bvh", "b/walk.bvh", "b/other.bvh")
        self.write("list.txt", "in/a/walk.bvh\nin/b/walk.bvh\n")
        clash = self.batch(inputs=("@list.txt",))
        self.assert_fails(clash, 2, "in/a/walk.bvh", "in/b/walk.bvh", "--relative-to")
        (self.folder / "in/a/walk.npz").write_bytes((self.folder / "in/a/walk.bvh").read_bytes())
        clash = self.batch(inputs=("in",))
        self.assert_fails(clash, 2, "in/a/walk.bvh", "in/a/walk.npz", "hint: rename one or exclude it")
        (self.folder / "in/a/walk.npz").unlink()
        self.assertFalse((self.folder / "out").exists())
        kept = self.batch("--relative-to", "in", inputs=("@list.txt",))
        self.assert_done(kept)
        self.assertNotIn("--base", kept.stderr)
        self.assertEqual(self.outputs(), ["a/walk.csv", "b/walk.csv"])
        outside = self.batch("--relative-to", "out", inputs=("@list.txt",), output="five")
        self.assert_fails(outside, 2, '"in/a/walk.bvh" is not inside the folder "out"',
                          "--relative-to")
        self.assert_done(self.batch(inputs=("in/*/w*.bvh",), output="two"))
        self.assertEqual(self.outputs("two"), ["a/walk.csv", "b/walk.csv"])
        self.assert_done(self.batch("--exclude", "a/*", output="three"))
        self.assertEqual(self.outputs("three"), ["b/other.csv", "b/walk.csv"])
        with open(self.write("one.txt", "in/b\n")) as names:
            self.assert_done(self.batch("--list", "-", inputs=(), output="four", stdin=names))
        self.assertEqual(self.outputs("four"), ["other.csv", "walk.csv"])

    def test_quality_of_every_motion_and_the_worst_first(self):
        self.write("in/wave.bvh", short_clip("wave", 10))
        self.write("in/get_up.bvh", short_clip("get_up", 20))
        self.write("in/bad.bvh", "HIERARCHY\n")
        result = self.batch("--method", "gmr", fast=False)
        self.assertEqual(result.returncode, 1, result.stderr)
        rows = self.summary()
        self.assertEqual(rows[0]["clip"], "bad.bvh")
        self.assertIn("bad.bvh:2:1: error", rows[0]["message"])
        missed = [int(row["gates_missed"]) for row in rows[1:]]
        self.assertEqual(missed, sorted(missed, reverse=True))
        entry = next(e for e in self.manifest() if e["relative"] == "wave.bvh")
        self.retarget("--method", "gmr", "--report", "r.json", bvh=self.folder / "in/wave.bvh")
        report = json.loads((self.folder / "r.json").read_text())
        measured = report["motions"][0]
        self.assertGreater(len(entry["quality"]["figures"]), 15)
        for key, value in entry["quality"]["figures"].items():
            found = measured[key]
            self.assertEqual(value, found[0] if isinstance(found, list) else found, key)

    def test_fit_equals_a_single_run(self):
        self.clips("walk.bvh", frames=8)
        self.assert_done(self.batch(fast=False))
        self.assert_done(self.retarget(bvh=self.folder / "in/walk.bvh"))
        self.assertEqual(self.contents()["walk.csv"], (self.folder / "out.csv").read_bytes())


    def test_summary_is_an_ordinary_clip_name(self):
        self.clips("summary.bvh")
        self.assert_done(self.batch("--format", "pkl-gmr"))
        self.assertEqual(self.outputs(end=".pkl"), ["summary.pkl"])
        self.assert_fails(self.batch(output="two"), 2, "summary.csv", "the batch itself")


class BadFiles(BatchTest):
    def test_do_not_stop_the_others(self):
        self.clips("a.bvh", "m/z.bvh")
        self.write("in/bad1.bvh", short_clip("wave", 2)[:-30] + b" x\n")
        self.write("in/m/empty.bvh", "")
        self.write("in/cut.pkl", b"\x80\x02}(U\x05po")
        (self.folder / "in/gone.bvh").symlink_to("nowhere")
        (self.folder / "in/lost.pkl").symlink_to("nowhere")
        os.symlink("..", self.folder / "in/m/loop")
        result = self.batch()
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(self.outputs(), ["a.csv", "m/z.csv"])
        failed = {e["relative"]: e["error"] for e in self.manifest() if e["status"] == "failed"}
        self.assertEqual(sorted(failed),
                         ["bad1.bvh", "cut.pkl", "gone.bvh", "lost.pkl", "m/empty.bvh"])
        self.assertEqual(failed["bad1.bvh"]["file"], "in/bad1.bvh")
        self.assertGreater(failed["bad1.bvh"]["line"], 100)
        self.assertGreater(failed["bad1.bvh"]["column"], 0)
        self.assertEqual(failed["bad1.bvh"]["exit_code"], 3)
        self.assertEqual(failed["cut.pkl"]["exit_code"], 3)
        self.assertIn("cut off", failed["cut.pkl"]["message"])
        self.assertIn("2 of 7 clips, 5 failed", result.stderr)
        self.assertIn("link back", result.stderr)
        quiet = self.batch("-q", output="quiet")
        self.assertEqual(quiet.stderr.count("error:"), 5)
        self.assertNotIn("of 7 clips", quiet.stderr)

    def test_a_clip_that_turns_bad_loses_its_output(self):
        self.clips("a.bvh", "b.bvh")
        self.assert_done(self.batch())
        self.write("in/a.bvh", "HIERARCHY\n")
        self.assertEqual(self.batch("--resume").returncode, 1)
        self.assertEqual(self.outputs(), ["b.csv"])
        self.clips("a.bvh")
        self.assert_done(self.batch("--resume"))
        self.assertEqual(self.outputs(), ["a.csv", "b.csv"])
        self.assertEqual([e["status"] for e in self.manifest()], ["done", "done"])

    def test_wrong_calls(self):
        self.clips("a.bvh")
        self.write("file", "")
        (self.folder / "empty").mkdir()
        both = short_clip("wave", 1)
        self.write("twins/a.bvh", both)
        self.write("twins/a.npz", b"PK")
        self.write("sum/summary.bvh", both)
        self.write("folder/a.bvh", both)
        self.write("folder/a.csv/b.bvh", both)
        self.write("own/manifest.jsonl/b.bvh", both)
        for code, words, arguments in (
                (2, ["no motion files"], ["batch", "-o", "x", "--robot", "unitree_g1"]),
                (2, ["no robot"], ["batch", "in", "-o", "x"]),
                (2, ["output"], ["batch", "in", "--robot", "unitree_g1"]),
                (2, ["not a folder"], ["batch", "in", "-o", "file", "--robot", "unitree_g1"]),
                (2, ["--shard"], ["batch", "in", "-o", "x", "--robot", "unitree_g1", "--shard",
                                  "3/2"]),
                (2, ["--resume", "--redo"], ["batch", "in", "-o", "x", "--robot", "unitree_g1",
                                             "--resume", "--redo"]),
                (2, ["a.bvh", "a.npz"], ["batch", "twins", "-o", "x", "--robot", "unitree_g1"]),
                (2, ["summary"], ["batch", "sum", "-o", "x", "--robot", "unitree_g1"]),
                (2, ["folder/a.csv/b.bvh", "\"a.csv\"", "folder/a.bvh"],
                 ["batch", "folder", "-o", "x", "--robot", "unitree_g1"]),
                (2, ["manifest.jsonl", "the batch itself"],
                 ["batch", "own", "-o", "x", "--robot", "unitree_g1"]),
                (2, ["\"in\" is the output folder"],
                 ["batch", "in", "-o", "in", "--robot", "unitree_g1"]),
                (2, ["twice"], ["batch", "in", "-o", "x", "--robot", "unitree_g1,unitree_g1"]),
                (2, ["--ik-config"], ["batch", "in", "-o", "x", "--robot", "unitree_g1,unitree_h1",
                                      "--ik-config", "m.json"]),
                (2, ["standard input"], ["batch", "-", "-o", "x", "--robot", "unitree_g1"]),
                (2, ["unknown option --bvh"], ["batch", "--bvh", "in", "-o", "x", "--robot",
                                               "unitree_g1"]),
                (2, ["--without"], ["batch", "in", "-o", "x", "--robot", "unitree_g1", "--method",
                                    "gmr", "--without", "floor"]),
                (3, ["empty"], ["batch", "empty", "-o", "x", "--robot", "unitree_g1"]),
                (3, ["nowhere"], ["batch", "nowhere", "-o", "x", "--robot", "unitree_g1"]),
                (3, ["*.bvh"], ["batch", "*.bvh", "-o", "x", "--robot", "unitree_g1"]),
                (4, ["unitree_g1"], ["batch", "in", "-o", "x", "--robot", "unitree_g2"])):
            with self.subTest(arguments=arguments):
                self.assert_fails(self.run_tool(*arguments), code, *words)
                self.assertFalse((self.folder / "x").exists())


if __name__ == "__main__":
    unittest.main()
