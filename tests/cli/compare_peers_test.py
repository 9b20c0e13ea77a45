"""bench/compare_peers works and its JSON is complete. How fast anything is, is not tested."""

import json
import os
import pathlib
import shlex
import subprocess
import sys
import unittest

from tool import SOURCE, TOOL, ToolTest, is_sanitized, sample

# Writes the requested rows; takes some time for more than one.
FAKE_PEER = """
import sys, time
frames, output = int(sys.argv[1]) or 301, sys.argv[2]
time.sleep(0.2 if frames > 1 else 0.0)
open(output, "w").write("0\\n" * frames)
"""


class ComparePeers(ToolTest):
    def compare(self, *arguments, **environment):
        command = [sys.executable, SOURCE / "bench/compare_peers", "--json", "out.json", *arguments]
        return subprocess.run([*map(str, command)], cwd=self.folder, text=True,
                              capture_output=True, timeout=300,
                              env=dict(os.environ, RETARGET_TOOL=TOOL, **environment))

    def report(self, result):
        self.assert_done(result)
        return json.loads((self.folder / "out.json").read_text())

    def test_without_the_peer_our_engines_run_alone(self):
        # Without shared data, the sample clip replaces it.
        result = self.compare("--repetitions", 1, RETARGET_SHARED=str(self.folder))
        report = self.report(result)
        self.assertIn("Python reference is missing", result.stderr)
        self.assertIn("retarget_oracle.py", report["peer"]["missing"])
        self.assertTrue(report["machine"]["cpu"])
        self.assertRegex(report["tool"]["version"][0], r"^retarget \d")
        self.assertRegex(report["tool"]["version"][1], r"^compiler ")
        [clip] = report["clips"]
        self.assertEqual((clip["clip"], clip["frames"]), ("walk", 301))
        self.assertEqual(list(clip["peers"]), ["fast", "reference"])
        for peer in clip["peers"].values():
            for figure in ("start_s", "whole_s", "cpu_s"):
                self.assertEqual(set(peer[figure]), {"median", "min", "max", "values"})
                self.assertEqual(len(peer[figure]["values"]), 1)
        self.assertGreater(clip["ratios"]["reference"]["whole"]["median"], 0)
        for words in ("machine", "load", "compiler", "walk, 301 frames", "fast to reference"):
            self.assertIn(words, result.stdout)

    def test_python_without_the_packages_is_reported(self):
        (self.folder / "oracle").mkdir()
        (self.folder / "oracle/retarget_oracle.py").touch()
        result = self.compare("--repetitions", 1, "--python", "no-such-python", sample("wave"),
                              RETARGET_SHARED=str(self.folder))
        self.assertIn("no-such-python", self.report(result)["peer"]["missing"])

    def test_ratios_to_a_peer(self):
        fake = self.write("fake peer.py", FAKE_PEER)
        peer = f"{shlex.quote(sys.executable)} {shlex.quote(str(fake))} {{frames}} {{output}}"
        report = self.report(self.compare("--repetitions", 2, "--peer-command", peer,
                                          sample("walk")))
        [clip] = report["clips"]
        self.assertEqual(clip["peers"]["peer"]["frames"], 301)
        self.assertFalse(clip["peers"]["peer"]["whole_is_estimated"])
        ratio = clip["ratios"]["peer"]["whole"]
        self.assertEqual(len(ratio["values"]), 2)
        ours, theirs = (clip["peers"][name]["whole_s"]["values"] for name in ("fast", "peer"))
        for value, a, b in zip(ratio["values"], ours, theirs):
            self.assertAlmostEqual(value, b / a)
        self.assertAlmostEqual(ratio["median"], sum(ratio["values"]) / 2)

    def test_a_peer_that_solves_fewer_frames(self):
        fake = self.write("fake.py", FAKE_PEER)
        peer = f"{shlex.quote(sys.executable)} {shlex.quote(str(fake))} {{frames}} {{output}}"
        report = self.report(self.compare("--repetitions", 1, "--peer-command", peer,
                                          "--frames", 50, sample("walk")))
        peer = report["clips"][0]["peers"]["peer"]
        self.assertEqual(peer["frames"], 50)
        self.assertTrue(peer["whole_is_estimated"])
        # Consistent with the rate for all 301 frames.
        expected = peer["start_s"]["median"] + 300 / peer["frames_per_s"]["median"]
        self.assertAlmostEqual(peer["whole_s"]["median"], expected)

    def test_a_loop_in_python(self):
        package = pathlib.Path(TOOL).resolve().parents[2] / "python"
        if is_sanitized():
            self.skipTest("the module of a sanitizer does not load into Python alone")
        if not (package / "retarget/__init__.py").exists():
            self.skipTest("the Python package is not built")
        result = self.compare("--repetitions", 2, "--no-peer", sample("walk"))
        loop = self.report(result)["clips"][0]["loop"]
        self.assertEqual((loop["frames"], loop["missing"], loop["ratios"]), (301, {}, {}))
        self.assertEqual(len(loop["frames_per_s"]["retarget"]["values"]), 2)
        self.assertGreater(loop["frames_per_s"]["retarget"]["min"], 0)
        self.assertIn("loop in Python, retarget", result.stdout)

    def test_faults_are_reported(self):
        for arguments, words in (((self.folder / "none.bvh",), "none.bvh"),
                                 (("--tool", "nothing", sample("walk")), "no tool at nothing"),
                                 (("--package", self.folder), "no package retarget"),
                                 (("--frames", 1), "--frames must be"),
                                 (("--peer-command", "false", sample("wave")), "false failed")):
            with self.subTest(words):
                result = self.compare("--repetitions", 1, *arguments)
                self.assertNotEqual(result.returncode, 0)
                self.assertIn(words, result.stderr)
                self.assertNotIn("Traceback", result.stderr)


if __name__ == "__main__":
    unittest.main()
