"""retarget batch: what goes where, what a second run does, what happens to bad files."""

import csv
import hashlib
import json
import os
import shutil
import signal
import stat
import subprocess
import time
import unittest

from tool import SOURCE, TOOL, ToolTest, sample, short_clip

FAST = ("--method", "gmr", "--no-quality")


class BatchTest(ToolTest):
    def batch(self, *arguments, inputs=("in",), output="out", robot="unitree_g1", fast=True,
              **options):
        return self.run_tool("batch", *inputs, "-o", output, *(["--robot", robot] if robot else []),
                             *(FAST if fast else ()), *arguments, **options)

    def clips(self, *names, folder="in", frames=2):
        for name in names:
            self.write(f"{folder}/{name}", short_clip("wave", frames))

    def manifest(self, path="out/manifest.jsonl"):
        return [json.loads(line) for line in (self.folder / path).read_text().splitlines()]

    def summary(self, path="out/summary.csv"):
        with open(self.folder / path, newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def outputs(self, folder="out", end=".csv"):
        root = self.folder / folder
        return sorted(str(f.relative_to(root)) for f in root.rglob("*" + end)
                      if f.name != "summary.csv")

    def contents(self, folder="out"):
        return {name: (self.folder / folder / name).read_bytes() for name in self.outputs(folder)}


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

    def test_names_that_are_no_utf8(self):
        name = os.fsdecode(b"bad\xff name.bvh")
        self.clips(name)
        self.assert_done(self.batch())
        self.assertEqual(self.outputs(), [os.fsdecode(b"bad\xff name.csv")])
        self.assertEqual(bytes.fromhex(self.manifest()[0]["relative_hex"]), b"bad\xff name.bvh")
        result = self.batch("--resume")
        self.assertIn("1 of 1 are done", result.stderr)

    def test_several_robots_have_folders_of_their_own(self):
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

    def test_lists_patterns_base_and_exclude(self):
        self.clips("a/walk.bvh", "b/walk.bvh", "b/other.bvh")
        self.write("list.txt", "in/a/walk.bvh\nin/b/walk.bvh\n")
        clash = self.batch(inputs=("@list.txt",))
        self.assert_fails(clash, 2, "in/a/walk.bvh", "in/b/walk.bvh", "--base")
        self.assertFalse((self.folder / "out").exists())
        self.assert_done(self.batch("--base", "in", inputs=("@list.txt",)))
        self.assertEqual(self.outputs(), ["a/walk.csv", "b/walk.csv"])
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

    def test_the_fit_is_the_same_as_alone(self):
        self.clips("walk.bvh", frames=8)
        self.assert_done(self.batch(fast=False))
        self.assert_done(self.retarget(bvh=self.folder / "in/walk.bvh"))
        self.assertEqual(self.contents()["walk.csv"], (self.folder / "out.csv").read_bytes())


    def test_summary_is_a_name_like_others_where_nothing_is_called_so(self):
        self.clips("summary.bvh")
        self.assert_done(self.batch("--format", "pkl-gmr"))
        self.assertEqual(self.outputs(end=".pkl"), ["summary.pkl"])
        self.assert_fails(self.batch(output="two"), 2, "summary.csv", "the batch itself")


class BadFiles(BatchTest):
    def test_do_not_stop_the_others(self):
        self.clips("a.bvh", "m/z.bvh")
        self.write("in/bad1.bvh", short_clip("wave", 2)[:-30] + b" x\n")
        self.write("in/m/empty.bvh", "")
        (self.folder / "in/gone.bvh").symlink_to("nowhere")
        os.symlink("..", self.folder / "in/m/loop")
        result = self.batch()
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(self.outputs(), ["a.csv", "m/z.csv"])
        failed = {e["relative"]: e["error"] for e in self.manifest() if e["status"] == "failed"}
        self.assertEqual(sorted(failed), ["bad1.bvh", "gone.bvh", "m/empty.bvh"])
        self.assertEqual(failed["bad1.bvh"]["file"], "in/bad1.bvh")
        self.assertGreater(failed["bad1.bvh"]["line"], 100)
        self.assertGreater(failed["bad1.bvh"]["column"], 0)
        self.assertEqual(failed["bad1.bvh"]["exit_code"], 3)
        self.assertIn("2 of 5 clips, 3 failed", result.stderr)
        self.assertIn("link back", result.stderr)
        quiet = self.batch("-q", output="quiet")
        self.assertEqual(quiet.stderr.count("error:"), 3)
        self.assertNotIn("of 5 clips", quiet.stderr)

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


class Resume(BatchTest):
    def test_second_run_wants_to_be_told(self):
        self.clips("a.bvh")
        self.assert_done(self.batch())
        self.assert_fails(self.batch(), 2, "--resume", "--redo")
        self.assert_done(self.batch("--redo"))
        self.assertEqual(len(self.manifest()), 1)

    def times(self):
        return {name: (self.folder / "out" / name).stat().st_mtime_ns for name in self.outputs()}

    def redone(self, *arguments, **options):
        """Which outputs another run writes again."""
        before = self.times()
        self.assert_done(self.batch("--resume", *arguments, **options))
        return [name for name, at in self.times().items() if before.get(name) != at]

    def test_only_what_is_not_done_or_has_changed(self):
        self.clips("a.bvh", "b.bvh", "c.bvh")
        self.assert_done(self.batch())
        whole = (self.folder / "out/manifest.jsonl").read_bytes()
        self.assertEqual(self.redone(), [])
        self.assertEqual((self.folder / "out/manifest.jsonl").read_bytes(), whole)
        os.utime(self.folder / "in/a.bvh")
        os.utime(self.folder / "out/b.csv", ns=(0, 0))
        self.assertEqual(self.redone(), [])
        self.assertEqual(len(self.manifest()), 3)
        self.clips("b.bvh", frames=3)
        self.assertEqual(self.redone(), ["b.csv"])
        (self.folder / "out/c.csv").write_text("another's work")
        self.assertEqual(self.redone(), ["c.csv"])
        (self.folder / "out/a.csv").unlink()
        self.clips("d.bvh")
        self.assertEqual(self.redone(), ["a.csv", "d.csv"])
        self.assertEqual(len(self.manifest()), 4)

    def test_changed_options_and_files_that_they_name(self):
        self.clips("a.bvh")
        self.assert_done(self.batch("--precision", "4"))
        self.assertEqual(self.redone("--precision", "5"), ["a.csv"])
        self.assertEqual(self.redone("--precision", "5", "--jobs", "2"), [])
        mapping = (SOURCE / "configs/lafan1_to_unitree_g1.json").read_text()
        self.write("map.json", mapping)
        self.assertEqual(self.redone("--ik-config", "map.json"), ["a.csv"])
        self.write("copy.json", mapping)
        self.assertEqual(self.redone("--ik-config", "copy.json"), [])
        self.write("map.json", mapping + " ")
        self.assertEqual(self.redone("--ik-config", "map.json"), ["a.csv"])
        self.assertEqual(len(self.manifest()), 1)

    def test_meshes_that_shapes_are_made_from(self):
        """The model as compiled has lost them, so its hash does not tell."""
        self.clips("a.bvh")
        robot = SOURCE / "robots/unitree_g1"
        at = '<body name="left_elbow_link"'
        before, behind = (robot / "model.xml").read_text().split(at)
        tag, behind = behind.split(">", 1)
        # the elbow's own shapes go before a mesh
        elbow, behind = behind.split("<body", 1)
        elbow = "\n".join(line for line in elbow.splitlines() if "<geom" not in line)
        asset = '<asset><mesh name="arm" file="arm.obj"/></asset>'
        self.write("bare.xml", before.replace("<worldbody>", asset + "<worldbody>") + at + tag +
                   '><geom type="mesh" mesh="arm"/>' + elbow + "<body" + behind)

        def arm(length):
            corners = [(x, y, z) for x in (0, length) for y in (-.02, .02) for z in (-.02, .02)]
            faces = ("1 2 4", "1 4 3", "5 8 6", "5 7 8", "1 6 2", "1 5 6", "3 4 8", "3 8 7",
                     "1 3 7", "1 7 5", "2 8 4", "2 6 8")
            self.write("arm.obj", "".join(f"v {x} {y} {z}\n" for x, y, z in corners) +
                       "".join(f"f {face}\n" for face in faces))

        arm(0.1)
        line = {"robot": None}
        options = ("--robot-xml", "bare.xml", "--ik-config", robot / "ik.json")
        self.assert_done(self.batch(*options, **line))
        self.assertEqual(self.redone(*options, **line), [])
        arm(0.2)
        self.assertEqual(self.redone(*options, **line), ["a.csv"])
        self.assertEqual(self.redone(*options, **line), [])

    def test_defaults_that_are_given_change_nothing(self):
        self.clips("a.bvh")
        self.assert_done(self.batch())
        for given in (["--format", "csv"], ["--fps", "30.0"], ["--precision", "06"],
                      ["--dof", "29"], ["--limits", "gmr"], ["--csv-header=false"]):
            self.assertEqual(self.redone(*given), [], given)
        self.assertEqual(self.redone("--dof", "23-pbhc"), ["a.csv"])
        self.assertEqual(self.redone("--dof", "23-pbhc", "--limits", "official"), ["a.csv"])

    def test_files_of_another_format_are_told_of(self):
        self.clips("a.bvh", "sub/b.bvh")
        self.assert_done(self.batch())
        result = self.batch("--resume", "--format", "pkl-gmr")
        self.assert_done(result)
        self.assertIn("2 files that earlier options made", result.stderr)
        self.assertIn("a.csv, sub/b.csv", result.stderr)
        self.assertEqual(self.outputs(), ["a.csv", "sub/b.csv"])
        self.assertEqual(self.outputs(end=".pkl"), ["a.pkl", "sub/b.pkl"])
        # the same files again are replaced, and nothing is to be told
        self.assertNotIn("earlier options", self.batch("--resume", "--format", "pkl-gmr",
                                                       "--fps", "25").stderr)

    def test_failed_clips_that_are_gone_are_no_failures(self):
        self.clips("a.bvh")
        bad = self.write("in/bad.bvh", "HIERARCHY\n")
        self.assertEqual(self.batch().returncode, 1)
        bad.unlink()
        self.assert_done(self.batch("--resume"))
        self.assertEqual([row["clip"] for row in self.summary()], ["a.bvh"])
        self.assert_done(self.run_tool("batch", "--merge", "-o", "out"))
        self.assertEqual([row["clip"] for row in self.summary()], ["a.bvh"])
        # the same from the manifests of parts
        self.write("in/bad.bvh", "HIERARCHY\n")
        self.clips("c.bvh")
        codes = [self.batch("--shard", f"{i}/2", output="parts").returncode for i in (1, 2)]
        self.assertEqual(sorted(codes), [0, 1])
        bad.unlink()
        self.assert_done(self.batch("--resume", output="parts"))
        self.assert_done(self.run_tool("batch", "--merge", "-o", "parts"))
        self.assertEqual([row["clip"] for row in self.summary("parts/summary.csv")],
                         ["a.bvh", "c.bvh"])

    def test_torn_and_foreign_lines_count_for_nothing(self):
        self.clips("a.bvh", "b.bvh")
        self.assert_done(self.batch())
        path = self.folder / "out/manifest.jsonl"
        lines = path.read_bytes().splitlines(keepends=True)
        path.write_bytes(b'{"other": 1}\n\xff\xfe\n' + lines[0] + lines[1][:-20])
        self.assertEqual(self.redone(), ["b.csv"])
        self.assertEqual([e["relative"] for e in self.manifest()], ["a.bvh", "b.bvh"])

    def test_unfinished_files_of_a_killed_run_are_removed(self):
        self.clips("sub/a.bvh")
        left = self.write("out/sub/.retarget-1-0.tmp", "half")
        self.assert_done(self.batch())
        self.assertFalse(left.exists())
        # parts may be at work beside each other, so the merging of them does it
        left = self.write("parts/sub/.retarget-1-0.tmp", "half")
        for part in ("1/2", "2/2"):
            self.assert_done(self.batch("--shard", part, output="parts"))
        self.assertTrue(left.exists())
        self.assert_done(self.run_tool("batch", "--merge", "-o", "parts"))
        self.assertFalse(left.exists())

    def test_interrupt_keeps_what_is_done(self):
        for i in range(30):
            self.clips(f"{i}.bvh", frames=12)
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=number):
                command = [TOOL, "batch", "in", "-o", f"out{number}", "--robot", "unitree_g1", *FAST]
                run = subprocess.Popen(command, cwd=self.folder, stderr=subprocess.PIPE, text=True)
                deadline = time.monotonic() + 60
                while len(self.outputs(f"out{number}")) < 2:
                    self.assertLess(time.monotonic(), deadline)
                    time.sleep(0.01)
                run.send_signal(number)
                _, text = run.communicate(timeout=30)
                self.assertEqual(run.returncode, 130, text)
                self.assertIn("--resume", text)
                entries = self.manifest(f"out{number}/manifest.jsonl")
                self.assertTrue(all(e["status"] == "done" for e in entries))
                self.assertEqual(sorted(e["outputs"][0]["file"] for e in entries),
                                 self.outputs(f"out{number}"))
                self.assertLess(len(entries), 30)
        self.assert_done(self.batch("--resume", output=f"out{signal.SIGINT}"))
        self.assertEqual(len(self.outputs(f"out{signal.SIGINT}")), 30)


class Isolation(BatchTest):
    """A clip that takes its process with it is a failed line and not the end."""

    def setUp(self):
        super().setUp()
        lines = sample("walk").read_text().splitlines(keepends=True)
        motion = next(i for i, line in enumerate(lines) if line.startswith("Frames:"))
        rows = lines[motion + 2:] * 100
        self.write("in/long.bvh", "".join([*lines[:motion], f"Frames: {len(rows)}\n",
                                           lines[motion + 1], *rows]))
        for i in range(6):
            self.clips(f"{i}.bvh", frames=2 + i)

    def assert_only_the_long_one_failed(self, *words):
        entries = {e["relative"]: e for e in self.manifest()}
        self.assertEqual(len(entries), 7)
        for name, entry in entries.items():
            self.assertEqual(entry["status"], "failed" if name == "long.bvh" else "done", entry)
        for word in words:
            self.assertIn(word, entries["long.bvh"]["error"]["message"])
        self.assertEqual(entries["long.bvh"]["error"]["exit_code"], 1)
        self.assertEqual(self.outputs(), [f"{i}.csv" for i in range(6)])
        self.assertEqual([row["status"] for row in self.summary()], ["failed"] + 6 * ["done"])

    @staticmethod
    def is_running(process):
        try:
            with open(f"/proc/{process}/stat") as file:
                return file.read().rsplit(")", 1)[1].split()[0] not in "ZX"
        except FileNotFoundError:
            return False

    def test_one_that_takes_too_long(self):
        for jobs in ("1", "3"):
            result = self.batch("--redo", "--clip-timeout", "0.5", "--jobs", jobs)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("long.bvh: error: the clip took longer than 0.5 s", result.stderr)
            self.assert_only_the_long_one_failed("longer than 0.5 s")
        # the timeout decides nothing about the motions that there are
        result = self.batch("--resume")
        self.assert_done(result)
        self.assertIn("6 of 7 are done", result.stderr)

    @unittest.skipUnless(os.path.exists("/proc/self/task"), "needs /proc")
    def test_one_that_crashes(self):
        # a sanitizer would make an exit of the signal
        plain = {**os.environ,
                 "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "") + ":handle_segv=0"}
        for number, word in ((signal.SIGSEGV, "signal 11"), (signal.SIGKILL, "memory ran out")):
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            with subprocess.Popen([TOOL, "batch", "in", "-o", "out", "--robot", "unitree_g1",
                                   "--jobs", "1", *FAST], cwd=self.folder, text=True, env=plain,
                                  stderr=subprocess.PIPE) as run:
                children = f"/proc/{run.pid}/task/{run.pid}/children"
                deadline = time.monotonic() + 60
                worker = None
                while worker is None and time.monotonic() < deadline:
                    with open(children) as file:
                        worker = next(iter(file.read().split()), None)
                # the longest comes first
                time.sleep(0.2)
                os.kill(int(worker), number)
                _, text = run.communicate(timeout=60)
            self.assertEqual(run.returncode, 1, text)
            self.assert_only_the_long_one_failed(word)

    @unittest.skipUnless(os.path.exists("/proc/self/task"), "needs /proc")
    def test_workers_end_with_the_batch_and_hold_no_lock(self):
        with subprocess.Popen([TOOL, "batch", "in", "-o", "out", "--robot", "unitree_g1", "--jobs",
                               "2", *FAST], cwd=self.folder, stderr=subprocess.DEVNULL) as run:
            children = f"/proc/{run.pid}/task/{run.pid}/children"
            deadline = time.monotonic() + 60
            workers = []
            while len(workers) < 2 and time.monotonic() < deadline:
                with open(children) as file:
                    workers = file.read().split()
            time.sleep(0.2)
            for worker in workers:
                held = [os.path.realpath(f"/proc/{worker}/fd/{fd}")
                        for fd in os.listdir(f"/proc/{worker}/fd")]
                self.assertFalse([name for name in held if "lock" in name or "manifest" in name])
            run.kill()
            run.wait()
        deadline = time.monotonic() + 10
        while any(self.is_running(worker) for worker in workers):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        self.assert_done(self.batch("--resume"))
        self.assertEqual(len(self.outputs()), 7)


class Shards(BatchTest):
    def test_parts_merge_into_the_whole(self):
        for i in range(7):
            self.clips(f"{i}.bvh", frames=1 + i)
        self.write("in/bad.bvh", "HIERARCHY\n")
        self.batch(output="whole")
        codes = [self.batch("--shard", f"{i}/3").returncode for i in (1, 2, 3)]
        self.assertEqual(sorted(codes), [0, 0, 1])
        self.assertFalse((self.folder / "out/summary.csv").exists())
        merged = self.batch("--merge", inputs=(), robot=None)
        self.assertEqual(merged.returncode, 1, merged.stderr)
        self.assertIn("8 clips, 1 failed", merged.stderr)
        self.assertEqual(self.contents(), self.contents("whole"))
        self.assertEqual((self.folder / "out/summary.csv").read_bytes(),
                         (self.folder / "whole/summary.csv").read_bytes())
        self.assertEqual(len(self.manifest()), 8)
        self.assertEqual([f for f in self.files() if "-of-" in f], [])
        result = self.batch("--shard", "2/3", "--resume")
        self.assertIn("are done and unchanged", result.stderr)

    def test_array_tasks_of_slurm_do_all_parts(self):
        for i in range(5):
            self.clips(f"{i}.bvh")
        script = SOURCE / "tools" / "slurm_batch.sbatch"

        def task(*arguments, **variables):
            result = subprocess.run(["bash", script, *arguments, "-o", "out"], cwd=self.folder,
                                    text=True, stderr=subprocess.PIPE,
                                    env={**os.environ, "RETARGET_TOOL": TOOL, **variables})
            self.assert_done(result)
            return result.stderr

        for number in ("11", "12", "13"):
            for again in (False, True):
                told = task("in", "--robot", "unitree_g1", *FAST, SLURM_ARRAY_TASK_ID=number,
                            SLURM_ARRAY_TASK_MIN="11", SLURM_ARRAY_TASK_COUNT="3",
                            SLURM_CPUS_PER_TASK="2")
                self.assertEqual("done and unchanged" in told, again)
        self.assertIn("5 clips, 0 failed", task("--merge"))
        self.assertEqual(len(self.outputs()), 5)

    @unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed")
    def test_gnu_parallel_does_all_parts(self):
        for i in range(5):
            self.clips(f"{i}.bvh")
        # `parallel` may be another program by that name
        version = subprocess.run(["parallel", "--version"], text=True, stdout=subprocess.PIPE,
                                 stderr=subprocess.DEVNULL)
        if not version.stdout.startswith("GNU parallel"):
            self.skipTest("parallel is another program")
        result = subprocess.run(["parallel", "--will-cite", TOOL, "batch", "in", "-o", "out",
                                 "--robot", "unitree_g1", *FAST, "--resume", "--jobs", "1",
                                 "--shard", "{}/3"], cwd=self.folder, input="1\n2\n3\n", text=True,
                                stderr=subprocess.PIPE)
        self.assert_done(result)
        self.assertEqual(len(self.outputs()), 5)
        self.assert_done(self.run_tool("batch", "--merge", "-o", "out"))

    def test_merge_without_anything(self):
        self.assert_fails(self.run_tool("batch", "--merge", "-o", "no"), 2, "no")
        (self.folder / "empty").mkdir()
        self.assert_fails(self.run_tool("batch", "--merge", "-o", "empty"), 3, "manifest")


class NothingIsLost(BatchTest):
    def test_wrong_options_touch_no_motion(self):
        self.clips("a.bvh", "b.bvh")
        self.assert_done(self.batch())
        (self.folder / "map.json").write_text("{}")
        for arguments, code in ((["--fps", "abc"], 2), (["--unit", "furlong"], 2),
                                (["--frames", "0:0"], 2), (["--map", "none.json"], 4)):
            for how in ("--resume", "--redo"):
                self.assertEqual(self.batch(how, *arguments).returncode, code, arguments)
        self.assertEqual(self.batch("--resume", "--start", "1000").returncode, 1)
        self.assertEqual(self.outputs(), ["a.csv", "b.csv"])

    def test_only_what_a_batch_made_is_removed(self):
        (self.folder / "in").mkdir()
        (self.folder / "in/z.bvh").write_text("junk")
        (self.folder / "out/y.csv").mkdir(parents=True)
        (self.folder / "out/z.csv").write_text("precious")
        (self.folder / "out/manifest_of_mine.jsonl").write_text("{}")
        for how in ([], ["--redo"]):
            self.assertEqual(self.batch(*how).returncode, 1)
        self.run_tool("batch", "--merge", "-o", "out")
        self.assertEqual((self.folder / "out/z.csv").read_text(), "precious")
        self.assertTrue((self.folder / "out/manifest_of_mine.jsonl").exists())
        self.assertTrue((self.folder / "out/y.csv").is_dir())

    def forge(self, **changes):
        """The manifest's only line with other values, `output` those of its first output."""
        path = self.folder / "out/manifest.jsonl"
        entry = json.loads(path.read_text())
        entry["outputs"][0].update(changes.pop("output", {}))
        entry.update(changes)
        path.write_text(json.dumps(entry) + "\n")

    def test_a_manifest_names_nothing_outside_its_folder(self):
        victim = self.write("victim.txt", "precious")
        record = {"bytes": 8, "modified_ns": victim.stat().st_mtime_ns,
                  "hash": "sha256:" + hashlib.sha256(b"precious").hexdigest()}
        for name in ("../victim.txt", str(victim), "up/victim.txt", "link.txt"):
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            self.clips("a.bvh")
            self.assert_done(self.batch())
            (self.folder / "out/up").symlink_to("..")
            (self.folder / "out/link.txt").symlink_to(victim)
            self.forge(output={"file": name, **record})
            self.write("in/a.bvh", "junk")
            result = self.batch("--resume")
            self.assertEqual(result.returncode, 1)
            self.assertEqual(victim.read_text(), "precious", name)
            self.assertTrue((self.folder / "out/link.txt").is_symlink())
            if not name.startswith(("up", "link")):
                self.assertIn(f'not inside the output folder, such as "{name}"', result.stderr)

    def test_a_body_model_is_for_smpl_motions(self):
        self.clips("a.bvh")
        self.assert_fails(self.batch("--smpl-model", "none.npz"), 4, "none.npz")
        clip = self.folder / "in/a.bvh"
        self.assert_fails(self.retarget("--smpl-model", "none.npz", bvh=clip), 2, "--smpl-model")
        self.write("body.npz", "any")
        self.assert_fails(self.retarget("--smpl-model", "body.npz", bvh=clip), 2, "--smpl-model")
        # the clips of a batch may be of both kinds
        self.assert_done(self.batch("--smpl-model", "body.npz"))

    def test_what_was_edited_since_is_not_removed(self):
        self.clips("a.bvh")
        self.assert_done(self.batch())
        kept = self.write("out/a.csv", "edited by hand\n")
        self.write("in/a.bvh", "junk")
        self.assertEqual(self.batch("--resume").returncode, 1)
        self.assertEqual(kept.read_text(), "edited by hand\n")

    def test_merging_removes_nothing_outside(self):
        self.clips("a.bvh")
        self.assert_done(self.batch())
        outside = self.write("place/.retarget-1-0.tmp", "half")
        (self.folder / "out/sub").mkdir()
        (self.folder / "out/link").symlink_to("../place")
        for relative in ("../place/a.bvh", "link/a.bvh"):
            self.forge(relative=relative)
            self.run_tool("batch", "--merge", "-o", "out")
            self.assertTrue(outside.exists(), relative)
            self.batch("--redo")

    def test_a_clock_that_was_ahead_does_not_undo_what_is_done(self):
        self.clips("a.bvh")
        good = (self.folder / "in/a.bvh").read_bytes()
        self.write("in/a.bvh", "junk")
        self.assertEqual(self.batch("--shard", "1/2").returncode, 1)
        path = self.folder / "out/manifest.1-of-2.jsonl"
        entry = json.loads(path.read_text())
        path.write_text(json.dumps({**entry, "finished": "2999-01-01T00:00:00.000Z"}) + "\n")
        (self.folder / "in/a.bvh").write_bytes(good)
        self.assert_done(self.batch("--resume"))
        self.assertEqual([e["status"] for e in self.manifest()], ["done"])
        self.assertEqual(self.summary()[0]["status"], "done")

    def test_what_failed_last_is_done_again(self):
        self.clips("a.bvh", "b.bvh")
        good = (self.folder / "in/a.bvh").read_bytes()
        self.assert_done(self.batch())
        (self.folder / "in/a.bvh").write_text("junk")
        for part in ("1/2", "2/2"):
            self.batch("--resume", "--shard", part)
        self.assertEqual(self.outputs(), ["b.csv"])
        (self.folder / "in/a.bvh").write_bytes(good)
        for part in ("1/2", "2/2"):
            self.assert_done(self.batch("--resume", "--shard", part))
        self.assert_done(self.run_tool("batch", "--merge", "-o", "out"))
        self.assertEqual(self.outputs(), ["a.csv", "b.csv"])


class Machine(BatchTest):
    def test_second_run_in_the_same_folder_is_refused(self):
        for i in range(20):
            self.clips(f"{i}.bvh", frames=20)
        command = [TOOL, "batch", "in", "-o", "out", "--robot", "unitree_g1", *FAST]
        first = subprocess.Popen(command, cwd=self.folder, stderr=subprocess.DEVNULL)
        try:
            deadline = time.monotonic() + 60
            while not (self.folder / "out/manifest.jsonl").exists():
                self.assertLess(time.monotonic(), deadline)
                time.sleep(0.001)
            # it must not be through before the others come
            first.send_signal(signal.SIGSTOP)
            self.assertIsNone(first.poll())
            for arguments in (["--resume"], ["--redo"], ["--resume", "--shard", "1/2"]):
                self.assert_fails(self.batch(*arguments), 1, f"process {first.pid}")
            merge = self.run_tool("batch", "--merge", "-o", "out")
            self.assert_fails(merge, 1, f"process {first.pid}")
        finally:
            first.kill()
            first.wait()
        # a killed run's lock is gone with it
        self.assert_done(self.batch("--resume"))
        self.assertEqual(len(self.outputs()), 20)

    @unittest.skipIf(os.geteuid() == 0, "root may write anywhere")
    def test_read_only_output_folder(self):
        self.clips("a.bvh")
        (self.folder / "out").mkdir()
        (self.folder / "out").chmod(stat.S_IRUSR | stat.S_IXUSR)
        self.addCleanup((self.folder / "out").chmod, 0o700)
        self.assert_fails(self.batch(), 1, "out")

    def test_output_that_cannot_be_made(self):
        self.clips("a.bvh")
        self.assert_fails(self.batch(output="/proc/out"), 1, "/proc/out")

    def test_full_disk(self):
        self.clips("a.bvh", frames=30)
        self.clips("b.bvh")
        # room for the short one, the manifest and the options; not for the long one
        script = 'ulimit -f 8; exec "$0" "$@"'
        result = subprocess.run(["bash", "-c", script, TOOL, "batch", "in", "-o", "out", "--robot",
                                 "unitree_g1", *FAST], cwd=self.folder, text=True,
                                stderr=subprocess.PIPE)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(self.outputs(), ["b.csv"])
        failed = [e for e in self.manifest() if e["status"] == "failed"]
        self.assertEqual([e["relative"] for e in failed], ["a.bvh"])
        self.assertEqual(failed[0]["error"]["exit_code"], 1)
        self.assert_done(self.batch("--resume"))
        self.assertEqual(self.outputs(), ["a.csv", "b.csv"])

    def test_full_disk_that_has_no_room_for_the_manifest(self):
        for i in range(16):
            self.clips(f"{i:02}.bvh")
        script = 'ulimit -f 4; exec "$0" "$@"'
        result = subprocess.run(["bash", "-c", script, TOOL, "batch", "in", "-o", "out", "--robot",
                                 "unitree_g1", "--jobs", "1", *FAST], cwd=self.folder, text=True,
                                stderr=subprocess.PIPE)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("cannot write the manifest", result.stderr)
        self.assertLess(len(self.outputs()), 16)
        self.assertTrue((self.folder / "out/manifest.jsonl").read_bytes().endswith(b"\n"))
        self.assert_done(self.batch("--resume"))
        self.assertEqual(len(self.outputs()), 16)


if __name__ == "__main__":
    unittest.main()
