"""A second run of retarget batch in the same folder loses nothing."""

import hashlib
import json
import os
import shutil
import signal
import struct
import subprocess
import time
import unittest

import gltf
from batch_runs import FAST, BatchTest
from tool import SOURCE, TOOL, sample


class Resume(BatchTest):
    def test_second_run_requires_resume(self):
        self.clips("a.bvh")
        self.assert_done(self.batch())
        self.assert_fails(self.batch(), 2, "--resume", "--redo")
        self.assert_done(self.batch("--redo"))
        self.assertEqual(len(self.manifest()), 1)

    def times(self):
        return {name: (self.folder / "out" / name).stat().st_mtime_ns for name in self.outputs()}

    def redone(self, *arguments, **options):
        """Returns the outputs that another run rewrites."""
        before = self.times()
        self.assert_done(self.batch("--resume", *arguments, **options))
        return [name for name, at in self.times().items() if before.get(name) != at]

    def test_only_missing_or_changed_clips_are_redone(self):
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

    def test_changed_buffers_of_gltf_files(self):
        folder = self.folder / "in"
        folder.mkdir()
        self.assert_done(self.run_tool("convert", str(sample("walk")), "walk.glb"))
        glb = gltf.Glb(self.folder / "walk.glb")
        glb.json["buffers"][0]["uri"] = "the%20numbers.bin"
        (folder / "walk.gltf").write_text(json.dumps(glb.json))
        (folder / "the numbers.bin").write_bytes(glb.binary)
        self.assert_done(self.batch("--sidecar"))
        self.assertEqual(self.redone("--sidecar"), [])
        self.assert_done(self.run_tool("verify", "out/walk.csv.json"))
        # The hips of a frame.
        numbers = bytearray(glb.binary)
        channels = glb.json["animations"][0]["channels"]
        path = next(c for c in channels if c["target"]["path"] == "translation")
        keys = glb.json["accessors"][glb.json["animations"][0]["samplers"][path["sampler"]]["output"]]
        at = glb.json["bufferViews"][keys["bufferView"]]["byteOffset"]
        numbers[at:at + 4] = struct.pack("<f", struct.unpack_from("<f", numbers, at)[0] + 0.01)
        (folder / "the numbers.bin").write_bytes(numbers)
        result = self.run_tool("verify", "out/walk.csv.json")
        self.assertIn("walk.gltf", result.stderr)
        self.assertNotEqual(result.returncode, 0)
        self.assertEqual([name for name in self.redone("--sidecar") if name.endswith(".csv")],
                         ["walk.csv"])

    def test_changed_options_and_files_that_they_name(self):
        self.clips("a.bvh")
        self.assert_done(self.batch("--precision", "4"))
        self.assertEqual(self.redone("--precision", "5"), ["a.csv"])
        self.assertEqual(self.redone("--precision", "5", "--jobs", "2"), [])
        config = (SOURCE / "configs/lafan1_to_unitree_g1.json").read_text()
        self.write("config.json", config)
        self.assertEqual(self.redone("--ik-config", "config.json"), ["a.csv"])
        self.write("copy.json", config)
        self.assertEqual(self.redone("--ik-config", "copy.json"), [])
        self.write("config.json", config + " ")
        self.assertEqual(self.redone("--ik-config", "config.json"), ["a.csv"])
        self.assertEqual(len(self.manifest()), 1)

    def test_meshes_that_shapes_are_made_from(self):
        """The compiled model lacks them, so its hash does not change."""
        self.clips("a.bvh")
        robot = SOURCE / "robots/unitree_g1"
        at = '<body name="left_elbow_link"'
        before, behind = (robot / "model.xml").read_text().split(at)
        tag, behind = behind.split(">", 1)
        # The elbow's own shapes take precedence over a mesh.
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

    def test_explicit_defaults_have_no_effect(self):
        self.clips("a.bvh")
        self.assert_done(self.batch())
        for given in (["--format", "csv"], ["--fps", "30.0"], ["--precision", "06"],
                      ["--dof", "29"], ["--limits", "gmr"], ["--csv-header=false"]):
            self.assertEqual(self.redone(*given), [], given)
        self.assertEqual(self.redone("--dof", "23-pbhc"), ["a.csv"])
        self.assertEqual(self.redone("--dof", "23-pbhc", "--limits", "official"), ["a.csv"])

    def test_files_of_another_format_are_reported(self):
        self.clips("a.bvh", "sub/b.bvh")
        self.assert_done(self.batch())
        result = self.batch("--resume", "--format", "pkl-gmr")
        self.assert_done(result)
        self.assertIn("2 files written by earlier options", result.stderr)
        self.assertIn("a.csv, sub/b.csv", result.stderr)
        self.assertEqual(self.outputs(), ["a.csv", "sub/b.csv"])
        self.assertEqual(self.outputs(end=".pkl"), ["a.pkl", "sub/b.pkl"])
        # The same files are replaced without a message.
        self.assertNotIn("earlier options", self.batch("--resume", "--format", "pkl-gmr",
                                                       "--fps", "25").stderr)

    def test_deleted_failed_clips_are_not_failures(self):
        self.clips("a.bvh")
        bad = self.write("in/bad.bvh", "HIERARCHY\n")
        self.assertEqual(self.batch().returncode, 1)
        bad.unlink()
        self.assert_done(self.batch("--resume"))
        self.assertEqual([row["clip"] for row in self.summary()], ["a.bvh"])
        self.assert_done(self.run_tool("batch", "--merge", "-o", "out"))
        self.assertEqual([row["clip"] for row in self.summary()], ["a.bvh"])
        # The same for the manifests of parts.
        self.write("in/bad.bvh", "HIERARCHY\n")
        self.clips("c.bvh")
        codes = [self.batch("--shard", f"{i}/2", output="parts").returncode for i in (1, 2)]
        self.assertEqual(sorted(codes), [0, 1])
        bad.unlink()
        self.assert_done(self.batch("--resume", output="parts"))
        self.assert_done(self.run_tool("batch", "--merge", "-o", "parts"))
        self.assertEqual([row["clip"] for row in self.summary("parts/summary.csv")],
                         ["a.bvh", "c.bvh"])

    def test_truncated_and_foreign_lines_are_ignored(self):
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
        # Parts may run at the same time, so only their merge removes files.
        left = self.write("parts/sub/.retarget-1-0.tmp", "half")
        for part in ("1/2", "2/2"):
            self.assert_done(self.batch("--shard", part, output="parts"))
        self.assertTrue(left.exists())
        self.assert_done(self.run_tool("batch", "--merge", "-o", "parts"))
        self.assertFalse(left.exists())

    def test_interrupt_keeps_finished_clips(self):
        self.clips(*(f"{i}.bvh" for i in range(10)))
        self.long_clip()
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=number):
                command = [TOOL, "batch", "in", "-o", f"out{number}", "--robot", "unitree_g1",
                           "--jobs", "2", *FAST]
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
                self.assertNotIn("long.bvh", [e["relative"] for e in entries])
        self.assert_done(self.batch("--resume", output=f"out{signal.SIGINT}"))
        self.assertEqual(len(self.outputs(f"out{signal.SIGINT}")), 11)


class NothingIsLost(BatchTest):
    def test_an_empty_manifest_can_be_resumed(self):
        self.clips("a.bvh")
        self.write("out/manifest.jsonl", "")
        self.write("out/options.json", "[]")
        self.assert_done(self.batch("--resume"))

    def test_redo_names_the_motions_that_it_leaves(self):
        self.clips("a.bvh", "b.bvh", "c.bvh")
        self.assert_done(self.batch(robot="unitree_g1,booster_t1"))
        for name in ("b.bvh", "c.bvh"):
            (self.folder / "in" / name).unlink()
        for times in (1, 0):
            done = self.batch("--redo", robot="unitree_g1,booster_t1")
            self.assert_done(done)
            self.assertEqual(done.stderr.count("4 files of the discarded batch remain"), times)

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

    def test_only_files_of_a_batch_are_removed(self):
        (self.folder / "in").mkdir()
        (self.folder / "in/z.bvh").write_text("junk")
        (self.folder / "out/y.csv").mkdir(parents=True)
        (self.folder / "out/z.csv").write_text("precious")
        (self.folder / "out/manifest_of_mine.jsonl").write_text("{}")
        for how, code in (([], 2), (["--redo"], 1)):
            self.assertEqual(self.batch(*how).returncode, code)
        self.run_tool("batch", "--merge", "-o", "out")
        self.assertEqual((self.folder / "out/z.csv").read_text(), "precious")
        self.assertTrue((self.folder / "out/manifest_of_mine.jsonl").exists())
        self.assertTrue((self.folder / "out/y.csv").is_dir())

    def forge(self, **changes):
        """Replaces values in the manifest's only line; `output` applies to its first output."""
        path = self.folder / "out/manifest.jsonl"
        entry = json.loads(path.read_text())
        entry["outputs"][0].update(changes.pop("output", {}))
        entry.update(changes)
        path.write_text(json.dumps(entry) + "\n")

    def test_manifest_paths_stay_inside_the_folder(self):
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
        # The clips of a batch may have both formats.
        self.assert_done(self.batch("--smpl-model", "body.npz"))

    def test_edited_files_are_not_removed(self):
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

    def test_clock_skew_does_not_redo_clips(self):
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

    def test_failed_clips_are_done_again(self):
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


if __name__ == "__main__":
    unittest.main()
