"""bench/live_soak.py in seconds: minutes of a stream, and detection of the faults that it looks for."""

import stat
import subprocess
import sys
import unittest

from tool import SOURCE, TOOL, ToolTest, is_sanitized, sample

SOAK = SOURCE / "bench/live_soak.py"

# Returns a frame for each row except every thousandth, or leaks every row.
FAULTY = """#!{python}
import sys
kept = []
print("first", flush=True)
for i, row in enumerate(sys.stdin):
    if {keeps}:
        kept.append(row * 4)
    if {loses} and i == 1000:
        continue
    print("frame", flush=True)
"""


class Soak(ToolTest):
    def soak(self, tool, *arguments, minutes=2.0):
        return subprocess.run([sys.executable, SOAK, tool, sample("walk"), "--minutes", str(minutes), *arguments],
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=500)

    def test_frames_and_memory_of_both_modes(self):
        # A sanitizer is ten times slower and keeps freed memory.
        memory = ["--any-memory"] if is_sanitized() else []
        for mode, minutes in (([], 2.0), (["--lag", "0.2"], 1.0)):
            minutes = 0.3 if is_sanitized() else minutes
            result = self.soak(TOOL, *mode, *memory, minutes=minutes)
            self.assertEqual(result.returncode, 0, f"{mode}: {result.stdout}{result.stderr}")
            sent = int(60 * 50 * minutes)
            self.assertIn(f"{sent} frames of {sent} rows", result.stdout)

    def test_faults_are_noticed(self):
        for keeps, loses, message in ((True, False, "memory has grown"), (False, True, "frames")):
            tool = self.write("faulty", FAULTY.format(python=sys.executable, keeps=keeps, loses=loses))
            tool.chmod(tool.stat().st_mode | stat.S_IXUSR)
            result = self.soak(tool, "--patience", "2")
            self.assertNotEqual(result.returncode, 0, result.stdout)
            self.assertIn(message, result.stderr)


if __name__ == "__main__":
    unittest.main()
