"""tools/batch_retarget.sh with a stand-in for the retarget program."""

import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = SOURCE / "tools" / "batch_retarget.sh"

# writes its arguments into the output; fails for inputs named bad*, dawdles for slow*
STAND_IN = """#!/bin/bash
arguments=("$@")
while [ $# -gt 0 ]; do
  case $1 in
    --bvh) input=$2; shift ;;
    -o) output=$2; shift ;;
  esac
  shift
done
case ${input##*/} in
  bad*) echo "$input:1:1: error: not a BVH file" >&2; exit 3 ;;
  slow*) : > "$output.started"; exec sleep 60 ;;
esac
echo "some summary" >&2
printf '%s\\n' "${arguments[@]}" > "$output"
"""


class BatchRetarget(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="batch test "))
        self.addCleanup(shutil.rmtree, self.folder)
        self.program = self.folder / "retarget"
        self.program.write_text(STAND_IN)
        self.program.chmod(0o755)
        self.scratch = self.folder / "scratch"
        self.scratch.mkdir()
        self.environment = {**os.environ, "RETARGET_TOOL": str(self.program),
                            "TMPDIR": str(self.scratch)}

    def make(self, *names, folder="in"):
        for name in names:
            file = self.folder / folder / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("HIERARCHY\n")

    def run_batch(self, *arguments, **options):
        return subprocess.run(["bash", str(SCRIPT), *arguments], cwd=self.folder, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=60,
                              env=options.get("env", self.environment))

    def outputs(self, folder="out"):
        root = self.folder / folder
        return sorted(str(f.relative_to(root)) for f in root.rglob("*") if f.is_file())

    def test_sub_folders_are_mirrored_and_any_name_serves(self):
        self.make("walk.bvh", "sub/a b/run.BVH", "sub/-dash.bvh", "läuft ünd.bvh", "-.bvh",
                  "quote ' \" $(x) *.bvh", "new\nline.bvh", "two.dots.bvh", "notes.txt")
        result = self.run_batch("in", "out", "--jobs", "3")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.outputs(), sorted([
            "walk.csv", "sub/a b/run.csv", "sub/-dash.csv", "läuft ünd.csv", "-.csv",
            "quote ' \" $(x) *.csv", "new\nline.csv", "two.dots.csv"]))
        self.assertIn("8 of 8 files done, 0 failed", result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(list(self.scratch.iterdir()), [])

    def test_options_reach_the_program_as_they_are(self):
        self.make("walk.bvh")
        result = self.run_batch("--robot=unitree_h1", "in", "out", "--", "--fps", "50", "a  b", "")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual((self.folder / "out/walk.csv").read_text().split("\n")[:-1], [
            "--robot", "unitree_h1", "--fps", "50", "a  b", "", "--bvh", "in/walk.bvh",
            "-o", "out/walk.csv"])

    def test_bad_files_do_not_stop_the_others(self):
        self.make("a.bvh", "bad1.bvh", "m/bad 2.bvh", "m/z.bvh", "z.bvh")
        result = self.run_batch("in", "out")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(self.outputs(), ["a.csv", "m/z.csv", "z.csv"])
        lines = result.stderr.splitlines()
        self.assertIn("in/bad1.bvh:1:1: error: not a BVH file", lines)
        self.assertEqual(lines[-3:], ["3 of 5 files done, 2 failed", "  failed: bad1.bvh",
                                      "  failed: m/bad 2.bvh"])

    def test_quiet_tells_failures_and_count_alone(self):
        self.make("a.bvh", "bad.bvh")
        result = self.run_batch("-q", "in", "out")
        self.assertNotIn("done: a.bvh", result.stderr)
        self.assertIn("failed (exit code 3): bad.bvh", result.stderr)

    def test_folders_that_look_like_options(self):
        self.make("a.bvh", folder="-in")
        result = self.run_batch("./-in", "./-out")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.outputs("-out"), ["a.csv"])

    def test_names_that_differ_in_the_ending_alone_do_not_overwrite_each_other(self):
        self.make("a.bvh", "a.BVH")
        self.assertEqual(self.run_batch("in", "out").returncode, 0)
        self.assertEqual(len(self.outputs()), 2)

    def test_wrong_calls(self):
        self.make("a.bvh")
        (self.folder / "empty").mkdir()
        (self.folder / "file").touch()
        for arguments, code, text in (
                (["in"], 2, "two folders"),
                (["in", "out", "third"], 2, "two folders"),
                (["--nonsense", "in", "out"], 2, "--nonsense"),
                (["in", "out", "--jobs", "0"], 2, "--jobs"),
                (["in", "out", "--robot"], 2, "--robot needs a value"),
                (["in", "file"], 2, "not a folder"),
                (["--retarget", "./no such", "in", "out"], 2, "no such"),
                (["nowhere", "out"], 3, "nowhere"),
                (["empty", "out"], 3, "no BVH file")):
            with self.subTest(arguments=arguments):
                result = self.run_batch(*arguments)
                self.assertEqual(result.returncode, code, result.stderr)
                self.assertIn(text, result.stderr)
                self.assertFalse((self.folder / "out").exists())

    def test_program_beside_the_script_is_found(self):
        self.make("a.bvh")
        beside = self.folder / "bin"
        beside.mkdir()
        shutil.copy(SCRIPT, beside / "batch_retarget.sh")
        shutil.copy(self.program, beside / "retarget")
        environment = {k: v for k, v in self.environment.items() if k != "RETARGET_TOOL"}
        result = subprocess.run(["bash", str(beside / "batch_retarget.sh"), "in", "out"],
                                cwd=self.folder, env=environment, stderr=subprocess.PIPE)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.outputs(), ["a.csv"])

    def test_interrupt_ends_every_process(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=number):
                shutil.rmtree(self.folder / "out", ignore_errors=True)
                self.make("slow1.bvh", "slow2.bvh", "slow3.bvh")
                # a marker that the processes of this run alone carry
                marker = f"BATCH_TEST_MARKER={self.folder.name}-{number}"
                name, value = marker.split("=")
                batch = subprocess.Popen(["bash", str(SCRIPT), "-j", "2", "in", "out"],
                                         cwd=self.folder, env={**self.environment, name: value},
                                         stderr=subprocess.PIPE, start_new_session=True,
                                         preexec_fn=heed_interrupts)
                deadline = time.monotonic() + 30
                while len(list(self.folder.glob("out/*.started"))) < 2:
                    self.assertLess(time.monotonic(), deadline)
                    time.sleep(0.02)
                batch.send_signal(number)
                _, text = batch.communicate(timeout=20)
                self.assertEqual(batch.returncode, 130, text)
                self.assertIn(b"interrupted", text)
                self.assertEqual(processes_with(marker), [])
                self.assertFalse((self.folder / "out/slow3.csv.started").exists())


def heed_interrupts():
    """A shell that starts its work with & makes it ignore SIGINT, and children inherit that."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def processes_with(marker):
    """Ids of the processes whose environment has the marker."""
    found = []
    for folder in pathlib.Path("/proc").iterdir():
        if folder.name.isdigit():
            try:
                if marker.encode() in (folder / "environ").read_bytes().split(b"\0"):
                    found.append(int(folder.name))
            except OSError:
                pass
    return found


if __name__ == "__main__":
    unittest.main()
