"""retarget batch as processes: clips that crash, parts on several machines, locks, full disks."""

import os
import shutil
import signal
import stat
import subprocess
import time
import unittest

from batch_runs import FAST, BatchTest
from tool import SOURCE, TOOL, processor_time


class Isolation(BatchTest):
    """A clip that crashes its process is a failed line; the batch continues."""

    def setUp(self):
        super().setUp()
        self.long_clip()
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

    @staticmethod
    def files_of_the_batch(worker):
        held = [os.path.realpath(f"/proc/{worker}/fd/{fd}") for fd in os.listdir(f"/proc/{worker}/fd")]
        return [name for name in held if "lock" in name or "manifest" in name]

    def test_clip_that_takes_too_long(self):
        for jobs in ("1", "3"):
            result = self.batch("--redo", "--clip-timeout", "0.5", "--jobs", jobs)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("long.bvh: error: the clip took longer than 0.5 s", result.stderr)
            self.assert_only_the_long_one_failed("longer than 0.5 s")
        # The timeout does not affect motions that are already done.
        result = self.batch("--resume")
        self.assert_done(result)
        self.assertIn("6 of 7 are done", result.stderr)

    @unittest.skipUnless(os.path.exists("/proc/self/task"), "needs /proc")
    def test_clip_that_crashes(self):
        # A sanitizer would turn the signal into an exit code.
        plain = dict(os.environ)
        for options in ("ASAN_OPTIONS", "TSAN_OPTIONS"):
            plain[options] = os.environ.get(options, "") + ":handle_segv=0"
        # earlyoom sends SIGTERM first.
        for number, word in ((signal.SIGSEGV, "signal 11"), (signal.SIGKILL, "memory may have run out"),
                             (signal.SIGTERM, "memory may have run out")):
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
                # The longest starts first.
                while processor_time(int(worker)) < 0.1:
                    time.sleep(0.005)
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
            for worker in workers:
                # A new process closes the batch's files first. If it did not, it would hold them until its end.
                while held := self.files_of_the_batch(worker):
                    self.assertLess(time.monotonic(), deadline, held)
                self.assertTrue(self.is_running(worker))
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
        merged = self.run_tool("batch", "--merge", "-o", "out")
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
                messages = task("in", "--robot", "unitree_g1", *FAST, SLURM_ARRAY_TASK_ID=number,
                                SLURM_ARRAY_TASK_MIN="11", SLURM_ARRAY_TASK_COUNT="3",
                                SLURM_CPUS_PER_TASK="2")
                self.assertEqual("done and unchanged" in messages, again)
        self.assertIn("5 clips, 0 failed", task("--merge"))
        self.assertEqual(len(self.outputs()), 5)

    @unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed")
    def test_gnu_parallel_does_all_parts(self):
        for i in range(5):
            self.clips(f"{i}.bvh")
        # `parallel` may be another program with this name.
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


class Machine(BatchTest):
    def test_second_run_in_the_same_folder_is_refused(self):
        self.clips(*(f"{i}.bvh" for i in range(6)))
        # It must not finish before the others arrive.
        self.long_clip()
        command = [TOOL, "batch", "in", "-o", "out", "--robot", "unitree_g1", *FAST]
        first = subprocess.Popen(command, cwd=self.folder, stderr=subprocess.DEVNULL)
        try:
            deadline = time.monotonic() + 60
            while not (self.folder / "out/manifest.jsonl").exists():
                self.assertLess(time.monotonic(), deadline)
                time.sleep(0.001)
            first.send_signal(signal.SIGSTOP)
            self.assertIsNone(first.poll())
            for arguments in (["--resume"], ["--redo"], ["--resume", "--shard", "1/2"]):
                self.assert_fails(self.batch(*arguments), 1, f"process {first.pid}")
            merge = self.run_tool("batch", "--merge", "-o", "out")
            self.assert_fails(merge, 1, f"process {first.pid}")
        finally:
            first.kill()
            first.wait()
        # The lock of a killed run disappears with it.
        self.assert_done(self.batch("--resume"))
        self.assertEqual(len(self.outputs()), 7)

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
        # Space for the short clip, the manifest and the options, but not for the long clip.
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
