"""The command line agrees with the library behind it: records of runs, help, interrupts."""

import json
import signal
import subprocess
import time
import unittest

from tool import TOOL, ToolTest, sample, short_clip

G1 = ("--robot", "unitree_g1")


class Records(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("in/wave.bvh", short_clip("wave", 10))

    def batch(self, *options):
        return self.run_tool("batch", "in", "-o", "out", *G1, "--method", "gmr", *options)

    def test_a_batch_resumes_with_the_current_options(self):
        self.assert_done(self.batch("--no-quality"))
        again = self.batch("--no-quality", "--sidecar", "--resume")
        self.assert_done(again)
        self.assertTrue((self.folder / "out/wave.csv.json").exists(), again.stderr)
        self.assert_done(self.batch("--sidecar", "--resume"))
        entry = json.loads((self.folder / "out/manifest.jsonl").read_text().splitlines()[-1])
        self.assertTrue(entry["quality"]["figures"])
        last = self.batch("--sidecar", "--resume")
        self.assertIn("1 of 1 are done", last.stderr)

    def test_options_in_manifests_are_spelled(self):
        self.write("in/wave.bvh", sample("wave").read_bytes())
        self.batch("--fps", "1000", "--clip-timeout", "0.001")
        for name in ("manifest.jsonl", "summary.csv"):
            text = (self.folder / "out" / name).read_text()
            self.assertIn("--clip-timeout allows more time", text)
            self.assertNotIn("\\u000e", text)
            self.assertNotIn("\x0e", text)

    def sidecar(self, **changes):
        sidecar = json.loads((self.folder / "out.csv.json").read_text())
        for key, value in changes.items():
            part, _, name = key.partition("__")
            sidecar[part][name.replace("_", "-")] = value
        self.write("changed.json", json.dumps(sidecar))
        return self.run_tool("verify", "changed.json")

    def test_invalid_sidecars_are_rejected(self):
        self.assert_done(self.run_tool(*("--bvh", "in/wave.bvh"), *G1, "--method", "gmr", "-o", "out.csv",
                                       "--sidecar"))
        self.assert_done(self.sidecar())
        self.assert_done(self.sidecar(options__precision=6.0))
        for changes in ({"options__method": ""}, {"options__csv_quat": ""}, {"output__format": "bogus"},
                        {"output__format": ""}, {"options__rest": ""}):
            self.assert_fails(self.sidecar(**changes), 3, "changed.json")


class Help(ToolTest):
    def test_parts_of_a_command_show_their_own_options(self):
        shown = self.run_tool("edit", "trim", "--help").stdout
        for option in ("--start", "--end", "--frames"):
            self.assertIn(option, shown)
        self.assertNotIn("--lenient", shown)
        self.assertIn("--lenient", self.run_tool("edit", "trim", "--help-all").stdout)
        self.assertIn("--scale", self.run_tool("edit", "path", "--help").stdout)


class Interrupts(ToolTest):
    def test_reading_ends_at_once(self):
        for words in (("-", "g1", "-o", "x.csv"), ("batch", "--list", "-", "-o", "o", *G1)):
            process = subprocess.Popen([TOOL, *words], cwd=self.folder, stdin=subprocess.PIPE,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                       preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
            try:
                time.sleep(1.0)
                process.send_signal(signal.SIGINT)
                process.communicate(timeout=20)
                self.assertIn(process.returncode, (130, -signal.SIGINT), words)
            finally:
                process.kill()


class Evaluations(ToolTest):
    def test_summary_omits_the_robot(self):
        self.write("wave.bvh", short_clip("wave", 20))
        self.assert_done(self.run_tool("wave.bvh", "g1", "-o", "wave.csv"))
        evaluated = self.run_tool("evaluate", "wave.csv", *G1, "--bvh", "wave.bvh", "--gate", "none")
        self.assert_done(evaluated)
        self.assertIn("taken as", evaluated.stderr)
        self.assertNotIn("limits official, configuration", evaluated.stderr)

    def test_terms_may_be_separated_by_blanks(self):
        self.write("wave.bvh", short_clip("wave", 5))
        self.assert_done(self.run_tool("wave.bvh", "g1", "-o", "x.csv", "--without", "floor",
                                       "contact"))


if __name__ == "__main__":
    unittest.main()
