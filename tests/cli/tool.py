"""Support for tests of the command line: running the tool, sample clips, comparing tables."""

import functools
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import threading
import unittest

# A shell makes background processes ignore SIGINT, and Python and the tool would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TOOL = os.environ.get("RETARGET_TOOL", "")
NODE = shutil.which("node")
MEGABYTE = 1 << 20
# Reference data and captured motions, which are not in the repository.
SHARED = pathlib.Path(os.environ.get("RETARGET_SHARED") or SOURCE.parent / "shared")
SAMPLES = ("walk", "turn_in_place", "squat", "wave", "get_up")


needs_shared = unittest.skipUnless(
    (SHARED / "data").is_dir(), "no folder of shared data: set RETARGET_SHARED to run this test")
# tools/windows.sh tests the program for Windows, which has no signals, limits, permissions or terminals of POSIX.
needs_posix = unittest.skipIf(
    os.environ.get("RETARGET_TOOL_SYSTEM") == "windows", "signals, limits, permissions or terminals of POSIX")


@functools.cache
def is_sanitized():
    """Whether the tool was built with a sanitizer, which needs more memory and time."""
    return bool(TOOL) and b"__asan_init" in pathlib.Path(TOOL).read_bytes()


def processor_time(process):
    """Returns the processor time of a running process by its number, in seconds."""
    fields = pathlib.Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def absent(what):
    """Skips a test that lacks a dependency which tools/setup.sh installs; in strict mode the test fails.

    RETARGET_STRICT_TESTS=1 is the strict mode (.ci/run): a test that CI skips proves nothing.
    """
    if os.environ.get("RETARGET_STRICT_TESTS", "0") not in ("", "0"):
        raise AssertionError(f"{what}, and RETARGET_STRICT_TESTS is set")
    raise unittest.SkipTest(what)


def run_in_node(test, script):
    """The JSON output of a JavaScript script; an error of the script fails the test."""
    done = subprocess.run(
        [NODE, "--input-type=module", "-"],
        input=script,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    test.assertEqual(done.returncode, 0, done.stderr)
    return json.loads(done.stdout)


def sample(name):
    return SOURCE / "data" / f"{name}.bvh"


def short_clip(name, frames):
    """The first frames of a sample, as the bytes of a BVH file."""
    lines = sample(name).read_text().splitlines()
    motion = next(i for i, line in enumerate(lines) if line.startswith("Frames:"))
    head = [*lines[:motion], f"Frames: {frames}", lines[motion + 1]]
    return ("\n".join([*head, *lines[motion + 2:motion + 2 + frames]]) + "\n").encode()


def moved_clip(name, frames, move):
    """The first frames of a sample. move(frame, place) changes the place of its root, x, y, z in cm, y up."""
    lines = short_clip(name, frames).decode().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("Frame Time:")) + 1
    for i in range(first, len(lines)):
        values = lines[i].split()
        values[:3] = [str(x) for x in move(i - first, [float(x) for x in values[:3]])]
        lines[i] = " ".join(values)
    return "\n".join(lines) + "\n"


def raised_clip(name="squat", frames=60, height=20.0):
    """The first frames of a sample, by default on a step of 20 cm."""
    return moved_clip(name, frames, lambda _, place: [place[0], place[1] + height, place[2]])


def read_rows(text):
    """Rows of comma-separated numbers."""
    return [[float(value) for value in line.split(",")] for line in text.splitlines()]


def unwrapped(text):
    """Joins message lines that were wrapped at 80 columns."""
    return re.sub(r"\n(?: {11}| {4})(?=\S)", " ", text)


def difference(found, expected, tolerance):
    """Describes the largest difference of two tables of rows; None if they agree."""
    if len(found) != len(expected):
        return f"{len(found)} frames for {len(expected)}"
    worst, where = 0.0, None
    for frame, (row, wanted) in enumerate(zip(found, expected)):
        if len(row) != len(wanted):
            return f"frame {frame} has {len(row)} columns for {len(wanted)}"
        for column, (a, b) in enumerate(zip(row, wanted), 1):
            # The negated comparison counts NaN as a difference.
            if not abs(a - b) <= worst:
                worst = abs(a - b)
                where = f"frame {frame}, column {column}: {a} for {b}, difference {worst:.3g}"
    return where if not worst <= tolerance else None


class ToolTest(unittest.TestCase):
    """A test with a temporary folder, in which the tool runs."""

    def setUp(self):
        if not TOOL:
            self.skipTest("the tool is not built")
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="retarget test "))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def rows(self, name):
        """The rows of a CSV of numbers in the folder."""
        return read_rows((self.folder / name).read_text())

    def report(self, name):
        """The report on the first motion of a file in the folder."""
        return json.loads((self.folder / name).read_text())["motions"][0]

    def tool_environment(self, **variables):
        """Returns the environment without robots installed by the user."""
        return {**os.environ, "XDG_DATA_HOME": str(self.folder / "data home"), **variables}

    def run_tool(self, *arguments, **options):
        """The tool's result; `printed` has the unchanged messages, `stderr` a line for each."""
        options.setdefault("stdin", subprocess.DEVNULL)
        options.setdefault("env", self.tool_environment())
        result = subprocess.run([TOOL, *map(str, arguments)], cwd=self.folder, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300,
                                **options)
        result.printed = result.stderr
        result.stderr = unwrapped(result.stderr)
        return result

    def run_measured(self, *arguments, seconds=60, **options):
        """Returns the tool's result with `peak`, its peak memory in bytes.

        The tool must take less than `seconds` of processor time, because other processes change the time that passes.
        """
        with open(self.folder / "messages", "w+") as messages:
            options.setdefault("stdin", subprocess.DEVNULL)
            options.setdefault("env", self.tool_environment())
            process = subprocess.Popen([TOOL, *map(str, arguments)], cwd=self.folder,
                                       stdout=subprocess.DEVNULL, stderr=messages, **options)
            # A process that does not end is killed, and then fails by its exit code.
            watchdog = threading.Timer(4 * seconds, process.kill)
            watchdog.start()
            _, status, usage = os.wait4(process.pid, 0)
            watchdog.cancel()
            process.returncode = os.waitstatus_to_exitcode(status)
            messages.seek(0)
            process.stderr = messages.read()
        process.peak = usage.ru_maxrss * 1024
        self.assertLess(usage.ru_utime + usage.ru_stime, seconds)
        return process

    def assert_small(self, result):
        """Asserts no signal and at most 300 MB."""
        self.assertGreaterEqual(result.returncode, 0, result.stderr)
        if is_sanitized():
            return
        self.assertLess(result.peak, 300 * MEGABYTE, result.stderr)

    def retarget(self, *arguments, bvh=None, robot="unitree_g1", output="out.csv", **options):
        return self.run_tool("--bvh", bvh or sample("wave"), "--robot", robot, "-o", output,
                             *arguments, **options)

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def files(self):
        return sorted(str(f.relative_to(self.folder)) for f in self.folder.rglob("*")
                      if f.is_file())

    def assert_done(self, result):
        self.assertEqual(result.returncode, 0, result.stderr)

    def assert_fails(self, result, code, *words):
        """Asserts one readable error (perhaps with a hint) with these words, and the exit code."""
        self.assertEqual(result.returncode, code, result.stderr)
        errors = [line for line in result.stderr.splitlines() if "error:" in line]
        self.assertEqual(len(errors), 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)
