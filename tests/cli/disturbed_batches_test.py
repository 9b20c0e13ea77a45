"""After any disturbance of a batch, `--resume` gives the result of an undisturbed one.

RETARGET_DISTURBED_CLIPS and RETARGET_DISTURBED_KILLS set how much (300 and 50 take minutes),
RETARGET_DISTURBED_SEED repeats a round; a failure names its seed.
"""

import ctypes
import json
import os
import pathlib
import random
import shutil
import signal
import stat
import subprocess
import sys
import time
import unittest

from tool import TOOL, ToolTest, is_sanitized, sample, short_clip

CLIPS = int(os.environ.get("RETARGET_DISTURBED_CLIPS", "30"))
KILLS = int(os.environ.get("RETARGET_DISTURBED_KILLS", "6"))
SEED = int(os.environ.get("RETARGET_DISTURBED_SEED", random.randrange(1 << 30)))
CLONE_NEWNS, MS_REC, MS_PRIVATE = 0x20000, 0x4000, 0x40000
# Keys that depend on the time of a clip's run, not on its result.
TIMES = ("finished", "seconds", "modified_ns")
OPTIONS = ("--sidecar", "--format", "csv,npz-mjlab")


def without_times(value):
    if isinstance(value, dict):
        return {k: without_times(v) for k, v in value.items() if k not in TIMES}
    return [without_times(v) for v in value] if isinstance(value, list) else value


def files_below(root, leave_out=()):
    """Returns all files below a folder with their bytes, links with their targets."""
    found = {}
    for path in root.rglob("*"):
        name = str(path.relative_to(root))
        if name.split("/")[0] in leave_out or path.is_dir():
            continue
        found[name] = os.readlink(path) if path.is_symlink() else path.read_bytes()
    return found


def own_mounts():
    """Whether this process may create private mounts."""
    if os.geteuid() != 0 or not sys.platform.startswith("linux"):
        return False
    libc = ctypes.CDLL(None, use_errno=True)
    return (libc.unshare(CLONE_NEWNS) == 0 and
            libc.mount(b"none", b"/", None, MS_REC | MS_PRIVATE, None) == 0)


def mount(*arguments):
    return subprocess.run(["mount", *map(str, arguments)], stderr=subprocess.PIPE).returncode == 0


def children_of(process):
    try:
        return [int(child) for child in
                pathlib.Path(f"/proc/{process}/task/{process}/children").read_text().split()]
    except OSError:
        return []


def runs_in_session(leader):
    """Whether a process of the session still runs; zombies do not count."""
    for stat_file in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, session = stat_file.read_text().rpartition(")")[2].split()[:4]
        except OSError:
            continue
        if int(session) == leader and state not in "ZX":
            return True
    return False


def wait_for_session(leader):
    """Waits for the workers of a killed batch: the kernel ends them after the batch, not with it."""
    deadline = time.monotonic() + 60
    while runs_in_session(leader) and time.monotonic() < deadline:
        time.sleep(0.005)


class Disturbed(ToolTest):
    """Tests with the same clips, of which only the first one runs the undisturbed batch."""

    known = None

    def setUp(self):
        super().setUp()
        if is_sanitized():
            self.skipTest("many runs, and a sanitizer makes them slow")
        self.chance = random.Random(f"{SEED} {self.id()}")
        names, lengths = ("wave", "walk", "squat", "turn_in_place", "get_up"), random.Random(SEED)
        for i in range(CLIPS):
            name = f"in/{i % 7:02}/clip {i:03}.bvh"
            self.write(name, short_clip(names[i % 5], lengths.randint(30, 60)))
        # Failures are results as well.
        self.write("in/03/bad.bvh", sample("wave").read_bytes()[:-400])
        self.write("beside/summary.csv", "not the batch's\n")
        self.before = files_below(self.folder)
        if Disturbed.known is None:
            started = time.monotonic()
            Disturbed.known = self.undisturbed(), time.monotonic() - started
        self.whole, self.seconds = Disturbed.known

    def command(self, *arguments):
        return [TOOL, "batch", "in", "-o", "out", "--robot", "unitree_g1", *OPTIONS, *arguments]

    def start(self, *arguments, **options):
        options.setdefault("stderr", subprocess.DEVNULL)
        return subprocess.Popen(self.command("--resume", *arguments), cwd=self.folder, text=True,
                                start_new_session=True, stdin=subprocess.DEVNULL, **options)

    @staticmethod
    def state_of(folder):
        """Returns everything that a batch left, except times."""
        found = files_below(folder)
        lines = found.pop("manifest.jsonl").decode().splitlines()
        found["manifest"] = [without_times(json.loads(line)) for line in lines]
        for name in [name for name in found if name.endswith((".csv.json", ".npz.json"))]:
            found[name] = without_times(json.loads(found[name]))
        return found

    def undisturbed(self):
        """Runs the same call in a separate folder with the same clips."""
        calm = self.folder / "calm"
        shutil.rmtree(calm, ignore_errors=True)
        calm.mkdir()
        (calm / "in").symlink_to("../in")
        result = subprocess.run(self.command(), cwd=calm, text=True, stdin=subprocess.DEVNULL,
                                stderr=subprocess.PIPE)
        self.assertEqual(result.returncode, 1, result.stderr)
        return self.state_of(calm / "out")

    def motions_in(self, output="out"):
        return {name: content for name, content in files_below(self.folder / output).items()
                if "/" in name and name.endswith((".csv", ".npz"))}

    def assert_whole_so_far(self, *states):
        """Asserts that every motion equals that of one of the undisturbed runs."""
        for name, content in self.motions_in().items():
            self.assertIn(content, [state.get(name) for state in states], f"{name}, seed {SEED}")

    def assert_ends_as(self, expected):
        result = self.run_tool(*self.command("--resume")[1:])
        self.assertEqual(result.returncode, 1, result.stderr)
        found = self.state_of(self.folder / "out")
        self.assertEqual(sorted(found), sorted(expected), f"seed {SEED}")
        for name, content in expected.items():
            self.assertEqual(found[name], content, f"{name}, seed {SEED}")
        left = [str(f) for f in (self.folder / "out").rglob(".*")]
        self.assertEqual(left, [], f"seed {SEED}")

    def assert_nothing_else_touched(self, before):
        self.assertEqual(files_below(self.folder, ("out", "calm")), before, f"seed {SEED}")

    def pause(self, longest=None):
        time.sleep(self.chance.uniform(0.0, longest or max(0.3, 8 * self.seconds / KILLS)))


class Killed(Disturbed):
    """kill -9 of everything, of the batch, or of a worker; sometimes with a second batch."""

    def kill_something(self, batch):
        how = self.chance.choice(("group", "batch", "worker", "worker, then batch"))
        if "worker" in how:
            workers = children_of(batch.pid)
            if workers:
                try:
                    os.kill(self.chance.choice(workers), signal.SIGKILL)
                except ProcessLookupError:
                    pass
        if how == "worker":
            # The remaining processes finish the clips.
            batch.wait(timeout=300)
            return how
        if how == "worker, then batch":
            self.pause(0.2)
        if how == "group":
            os.killpg(batch.pid, signal.SIGKILL)
        else:
            batch.kill()
        batch.wait(timeout=60)
        wait_for_session(batch.pid)
        return how

    def change_some_inputs(self, versions):
        """Changes the bytes of inputs, sometimes with the same size."""
        for _ in range(2):
            name = f"in/{self.chance.randrange(CLIPS) % 7:02}"
            clip = self.chance.choice(sorted((self.folder / name).glob("clip*.bvh")))
            key = str(clip.relative_to(self.folder))
            clip.write_bytes(self.chance.choice(versions[key]))

    def test_resumed_batch_equals_an_undisturbed_one(self):
        first = {name: content for name, content in self.before.items() if "clip" in name}
        second = {name: short_clip("wave", 30 + i % 20) for i, name in enumerate(sorted(first))}
        for name, content in second.items():
            self.write(name, content)
        other = self.undisturbed()
        for name, content in first.items():
            self.write(name, content)
        versions = {name: (first[name], second[name]) for name in first}
        kinds = {}
        for _ in range(KILLS):
            batch = self.start()
            self.pause()
            if self.chance.random() < 0.3:
                # The second batch is refused, or does the remaining clips if the first one has
                # ended.
                with self.start() as beside:
                    self.assertEqual(beside.wait(timeout=300), 1)
            kind = self.kill_something(batch)
            kinds[kind] = kinds.get(kind, 0) + 1
            self.assert_whole_so_far(self.whole, other)
            if self.chance.random() < 0.3:
                self.change_some_inputs(versions)
        before = files_below(self.folder, ("out", "calm"))
        print(f"seed {SEED}: {len(first)} clips, killed: {kinds}", file=sys.stderr)
        self.assert_ends_as(self.undisturbed())
        self.assert_nothing_else_touched(before)


class TwoAtOnce(Disturbed):
    def test_two_on_one_folder(self):
        for _ in range(max(2, KILLS // 5)):
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            both = [self.start(stderr=subprocess.PIPE) for _ in range(2)]
            texts = [batch.communicate(timeout=300)[1] for batch in both]
            # One is rejected, or runs after the other and finds all clips done.
            stopped = sum("another batch is writing" in text or "are done and unchanged" in text
                          for text in texts)
            self.assertEqual(stopped, 1, texts)
            self.assertEqual([batch.returncode for batch in both], [1, 1])
            self.assert_ends_as(self.whole)
        self.assert_nothing_else_touched(self.before)


class NoRoom(Disturbed):
    def fill(self, folder, leave):
        """Fills a file system except for some bytes."""
        there = os.statvfs(folder)
        # Unbuffered, because a buffer fails again when the file is closed.
        with open(folder / "filler", "wb", buffering=0) as file:
            room = there.f_bavail * there.f_frsize - leave
            try:
                file.write(bytes(max(0, room)))
            except OSError:
                pass
        return folder / "filler"

    def test_disk_that_fills_up_in_the_middle(self):
        if not own_mounts():
            self.skipTest("only root may mount a small disk")
        disk = self.folder / "out"
        disk.mkdir()
        if not mount("-t", "tmpfs", "-o", "size=64m", "tmpfs", disk):
            self.skipTest("a small disk cannot be mounted here")
        self.addCleanup(subprocess.run, ["umount", "-l", disk])
        for _ in range(max(3, KILLS // 5)):
            batch = self.start()
            self.pause(self.seconds / 4)
            filler = self.fill(disk, self.chance.choice((0, 4096, 65536)))
            batch.wait(timeout=300)
            self.assertEqual(batch.returncode, 1)
            self.assert_whole_so_far(self.whole)
            filler.unlink()
        self.assert_ends_as(self.whole)
        self.assert_nothing_else_touched(self.before)

    def test_files_that_may_not_grow(self):
        # Blocks of 512 bytes: from none to enough for most files.
        for blocks in self.chance.sample((0, 1, 2, 8, 20, 30, 40, 60, 100), 5):
            script = f'ulimit -f {blocks}; exec "$0" "$@"'
            result = subprocess.run(["bash", "-c", script, *self.command("--resume")],
                                    cwd=self.folder, text=True, stderr=subprocess.PIPE)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertNotIn("signal", result.stderr)
            self.assert_whole_so_far(self.whole)
        self.assert_ends_as(self.whole)
        self.assert_nothing_else_touched(self.before)


class ReadOnly(Disturbed):
    def forbid(self, folder):
        """Makes a folder read-only; returns a function that restores it."""
        if os.geteuid() != 0:
            folder.chmod(stat.S_IRUSR | stat.S_IXUSR)
            return lambda: folder.chmod(0o700)
        if not (mount("--bind", folder, folder) and
                mount("-o", "remount,bind,ro", folder, folder)):
            self.skipTest("folders cannot be made read-only for root here")
        return lambda: subprocess.run(["umount", "-l", folder], check=True)

    def test_folder_that_becomes_read_only_in_the_middle(self):
        if os.geteuid() == 0 and not own_mounts():
            self.skipTest("folders cannot be made read-only for root here")
        for turn in range(max(3, KILLS // 5)):
            place = "" if turn % 3 == 2 else f"{self.chance.randrange(7):02}"
            folder = self.folder / "out" / place
            folder.mkdir(parents=True, exist_ok=True)
            # A target that exists in the first round does not matter: remove some of them.
            for motion in self.chance.sample(sorted(folder.glob("*.csv")),
                                             min(3, len(list(folder.glob("*.csv"))))):
                motion.unlink()
            batch = self.start()
            self.pause(self.seconds / 4)
            allow = self.forbid(folder)
            try:
                batch.wait(timeout=300)
                self.assertEqual(batch.returncode, 1)
                self.assert_whole_so_far(self.whole)
            finally:
                allow()
        self.assert_ends_as(self.whole)
        self.assert_nothing_else_touched(self.before)


# The pause lets the test see a file that is named and not finished, however busy the machine is.
NO_NAMELESS_FILES = """#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>
static int open_named(const char *path, int flags, mode_t mode) {
  if ((flags & O_TMPFILE) == O_TMPFILE) return errno = EOPNOTSUPP, -1;
  int file = syscall(SYS_openat, AT_FDCWD, path, flags, mode);
  if (file >= 0 && strstr(path, "05/.retarget-")) usleep(200000);
  return file;
}
int open(const char *path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  mode_t mode = va_arg(more, mode_t);
  va_end(more);
  return open_named(path, flags, mode);
}
int open64(const char *path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  mode_t mode = va_arg(more, mode_t);
  va_end(more);
  return open_named(path, flags, mode);
}
"""


class NamedFiles(Disturbed):
    """File systems without unnamed files, such as network file systems."""

    def setUp(self):
        super().setUp()
        compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
        if compiler is None or not sys.platform.startswith("linux"):
            self.skipTest("no C compiler to make such a file system with")
        library = self.folder / "named.so"
        source = self.write("named.c", NO_NAMELESS_FILES)
        subprocess.run([compiler, "-shared", "-fPIC", "-o", library, source], check=True)
        # The loader ends a name at a blank, and the tool runs in this folder.
        self.environment = {**os.environ, "LD_PRELOAD": "./" + library.name}

    def unfinished(self):
        return [str(path) for path in (self.folder / "out").rglob(".retarget-*.tmp")]

    def test_a_terminated_clip_leaves_no_files(self):
        lines = sample("walk").read_text().splitlines(keepends=True)
        motion = next(i for i, line in enumerate(lines) if line.startswith("Frames:"))
        rows = lines[motion + 2:] * 100
        self.write("in/05/long.bvh", "".join([*lines[:motion], f"Frames: {len(rows)}\n",
                                              lines[motion + 1], *rows]))
        batch = self.start("--jobs", "1", env=self.environment)
        seen = False
        deadline = time.monotonic() + 60
        # The longest starts first.
        while not seen and batch.poll() is None and time.monotonic() < deadline:
            seen = bool(self.unfinished()) and bool(children_of(batch.pid))
            time.sleep(0.005)
        self.assertTrue(seen, "no named file was made")
        for worker in children_of(batch.pid):
            try:
                os.kill(worker, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.assertEqual(batch.wait(timeout=300), 1)
        self.assertEqual(self.unfinished(), [])


if __name__ == "__main__":
    unittest.main()
