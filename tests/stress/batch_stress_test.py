"""retarget batch under load and faults, in sizes that a test run can afford.

    tests/stress/batch_stress_test.py --big [--folder DIR] [--tool FILE] [NAME ...]

runs the sizes of a data set instead and prints what they took: `many` (2,000 clips), `broken`
(10,000 files, 5 % of them bad in every way of tests/bvh/conformance), `huge` (a BVH of 1.5 GB),
`killed` (kill -9 at 50 random moments), `full` (a tmpfs without room; as root). All by default.
RETARGET_STRESS_MB changes the size of the huge file.
"""

import argparse
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
import tool  # noqa: E402
from tool import SOURCE, short_clip  # noqa: E402

CONFORMANCE = SOURCE / "tests" / "bvh" / "conformance"
FAST = ("--method", "gmr", "--no-quality")


class Batch:
    """A folder with inputs, and runs of the tool in it."""

    def __init__(self, folder, program=None):
        self.folder = pathlib.Path(folder)
        self.program = program or tool.TOOL

    def command(self, *arguments, output="out"):
        return [self.program, "batch", "in", "-o", output, "--robot", "unitree_g1",
                *map(str, arguments)]

    def run(self, *arguments, output="out", **options):
        return subprocess.run(self.command(*arguments, output=output), cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)

    def write(self, name, content):
        path = self.folder / "in" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)

    def outputs(self, output="out"):
        root = self.folder / output
        return {str(f.relative_to(root)): f.read_bytes() for f in root.rglob("*.csv")
                if f.name != "summary.csv"}

    def manifest(self, output="out"):
        text = (self.folder / output / "manifest.jsonl").read_text()
        return [json.loads(line) for line in text.splitlines()]


def make_clips(batch, count, frames):
    for i in range(count):
        batch.write(f"{i % 20:02}/clip {i:05}.bvh",
                    short_clip(("wave", "walk", "squat")[i % 3], 1 + i % frames))


def make_broken(batch, good, bad):
    """Good clips, and bad ones: the conformance files, and clips damaged at random."""
    make_clips(batch, good, 4)
    kinds = sorted(CONFORMANCE.glob("*.bvh"))
    whole = short_clip("wave", 4)
    chance = random.Random(7)
    for i in range(bad):
        if i % 2 == 0:
            kind = kinds[i // 2 % len(kinds)]
            batch.write(f"bad/{i:04} {kind.name}", kind.read_bytes())
            continue
        at = chance.randrange(len(whole))
        damages = (whole[:at], whole[:at] + b"\0\xff" + whole[at:], whole[:at] + whole[at + 40:],
                   whole.replace(b"CHANNELS 3", b"CHANNELS 4", 1), b"PK\x03\x04" + whole[:at],
                   whole.replace(b" 0.", b" nan ", 3), b"")
        batch.write(f"bad/{i:04} damaged{i % 7}.bvh", damages[i // 2 % len(damages)])


def kill_and_resume(batch, reference, rounds, longest, chance, *arguments):
    """Kills the run `rounds` times, then lets it end. Returns the number of clips done by then."""
    done_when_killed = []
    for _ in range(rounds):
        run = subprocess.Popen(batch.command("--resume", *arguments), cwd=batch.folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(chance.uniform(0.0, longest))
        run.send_signal(signal.SIGKILL)
        run.wait()
        found = batch.outputs()
        for name, content in found.items():
            if content != reference[name]:
                raise AssertionError(f"{name} is not whole after a kill")
        done_when_killed.append(len(found))
    result = batch.run("--resume", *arguments, timeout=3600)
    return result, done_when_killed


class StressTest(unittest.TestCase):
    def setUp(self):
        if not tool.TOOL:
            self.skipTest("the tool is not built")
        folder = tempfile.mkdtemp(prefix="batch stress ")
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        self.batch = Batch(folder)

    def test_killed_again_and_again_it_ends_with_the_same_bytes(self):
        make_clips(self.batch, 40, 8)
        whole = self.batch.run(*FAST, output="whole")
        self.assertEqual(whole.returncode, 0, whole.stderr)
        reference = self.batch.outputs("whole")
        result, done = kill_and_resume(self.batch, reference, 8, 0.8, random.Random(3), *FAST)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.batch.outputs(), reference)
        self.assertEqual((self.batch.folder / "out/summary.csv").read_bytes(),
                         (self.batch.folder / "whole/summary.csv").read_bytes())
        self.assertEqual(len(self.batch.manifest()), 40)
        self.assertEqual(done, sorted(done))
        left = [f for f in (self.batch.folder / "out").rglob(".*")]
        self.assertEqual(left, [])

    def test_bad_files_of_every_kind(self):
        make_broken(self.batch, 20, 2 * len(list(CONFORMANCE.glob("*.bvh"))))
        result = self.batch.run(*FAST)
        self.assertEqual(result.returncode, 1, result.stderr)
        entries = self.batch.manifest()
        self.assertEqual(sum(e["status"] == "done" for e in entries if "bad/" not in e["relative"]),
                         20)
        failed = [e for e in entries if e["status"] == "failed"]
        self.assertGreater(len(failed), 60)
        for entry in failed:
            self.assertIn(entry["error"]["exit_code"], (2, 3), entry)
            self.assertTrue(entry["error"]["message"])
        self.assertEqual(set(self.batch.outputs()),
                         {e["outputs"][0]["file"] for e in entries if e["status"] == "done"})


# --- the sizes of a data set ---------------------------------------------------------------------


def measured(batch, *arguments, expected=0, **options):
    """Runs a batch; prints its closing line, its time and its peak memory."""
    log = tempfile.TemporaryFile("w+")
    start = time.monotonic()
    run = subprocess.Popen(batch.command(*arguments, **options), cwd=batch.folder, stderr=log)
    _, status, usage = os.wait4(run.pid, 0)
    run.returncode = os.waitstatus_to_exitcode(status)
    log.seek(0)
    lines = log.read().splitlines()
    reports = [line for line in lines if line.startswith(("done", "resume"))]
    print(f"  {' '.join(map(str, arguments))}: {time.monotonic() - start:.1f} s, peak "
          f"{usage.ru_maxrss / 1024:.0f} MB, {usage.ru_utime + usage.ru_stime:.1f} s of processor")
    for line in reports:
        print("   ", line)
    if run.returncode != expected:
        raise AssertionError(f"exit code {run.returncode}\n" + "\n".join(lines[-5:]))


def big_many(batch):
    make_clips(batch, 2000, 60)
    measured(batch, "--method", "gmr")
    measured(batch, "--method", "gmr", "--resume")
    measured(batch, *FAST, "--jobs", 1, output="one")
    measured(batch, *FAST, "--jobs", 16, output="sixteen")
    assert batch.outputs("one") == batch.outputs("sixteen") == batch.outputs()


def big_broken(batch):
    make_broken(batch, 9500, 500)
    measured(batch, *FAST, expected=1)
    statuses = [e["status"] for e in batch.manifest()]
    print(f"    {statuses.count('failed')} of {len(statuses)} failed")


def big_huge(batch):
    size = int(os.environ.get("RETARGET_STRESS_MB", "1500")) * 1_000_000
    clip = (SOURCE / "data" / "walk.bvh").read_text()
    head, rows = clip.split("Frame Time:", 1)
    time_line, rows = rows.split("\n", 1)
    frames = rows.count("\n")
    times = size // len(rows)
    path = batch.folder / "in" / "huge.bvh"
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w") as file:
        file.write(head.replace(f"Frames: {frames}", f"Frames: {frames * times}"))
        file.write(f"Frame Time:{time_line}\n")
        for _ in range(times):
            file.write(rows)
    print(f"  {path.stat().st_size / 1e6:.0f} MB, {frames * times} frames")
    measured(batch, *FAST)


def big_killed(batch):
    make_clips(batch, 300, 60)
    for options in (FAST, ("--method", "gmr", "--jobs", 4)):
        for name in ("out", "whole"):
            shutil.rmtree(batch.folder / name, ignore_errors=True)
        start = time.monotonic()
        batch.run(*options, output="whole")
        longest = (time.monotonic() - start) / 10
        reference = batch.outputs("whole")
        seed = random.randrange(1 << 30)
        result, done = kill_and_resume(batch, reference, 50, longest, random.Random(seed), *options)
        assert result.returncode == 0, result.stderr
        assert batch.outputs() == reference
        for name in ("summary.csv", "options.json"):
            whole = (batch.folder / "whole" / name).read_bytes()
            assert (batch.folder / "out" / name).read_bytes() == whole, name
        print(f"  seed {seed}: killed with {done} of 300 done; the end is the same")


def big_full(batch):
    if os.geteuid() != 0:
        print("  only as root")
        return
    make_clips(batch, 200, 60)
    place = batch.folder / "small"
    place.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(place)], check=True)
    try:
        result = batch.run(*FAST, output="small/out")
        print(f"  exit code {result.returncode}:", result.stderr.splitlines()[-2:])
        assert result.returncode == 1 and "space" in result.stderr
        outputs = batch.outputs("small/out")
        subprocess.run(["mount", "-o", "remount,size=64m", str(place)], check=True)
        result = batch.run(*FAST, "--resume", output="small/out")
        assert result.returncode == 0, result.stderr
        after = batch.outputs("small/out")
        assert all(after[name] == content for name, content in outputs.items())
        print(f"  {len(outputs)} outputs whole when it was full, {len(after)} after --resume")
    finally:
        subprocess.run(["umount", str(place)], check=True)


BIG = {"many": big_many, "broken": big_broken, "huge": big_huge, "killed": big_killed,
       "full": big_full}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--big", action="store_true")
    parser.add_argument("--folder", help="where the files go (default: a temporary folder)")
    parser.add_argument("--tool", default=tool.TOOL, help="the retarget program")
    parser.add_argument("names", nargs="*", default=[], help=", ".join(BIG))
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.tool).resolve())
    for name in arguments.names or BIG:
        print(name, flush=True)
        folder = tempfile.mkdtemp(prefix=f"batch {name} ", dir=arguments.folder)
        try:
            BIG[name](Batch(folder, program))
        finally:
            shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main() if "--big" in sys.argv else unittest.main()
