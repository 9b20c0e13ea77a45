"""`retarget view FOLDER`: interrupts, failures and memory of its worker processes."""

import contextlib
import os
import pathlib
import re
import signal
import subprocess
import time
import unittest

from galleries import GalleryTest
from tool import SOURCE, TOOL, is_sanitized


class GalleryProcesses(GalleryTest):
    def data_with_a_gate_of_its_own(self):
        """A data folder whose gates are a pipe, so that making a page waits for them."""
        data = self.folder / "data"
        data.mkdir()
        for name in ("robots", "configs"):
            source = SOURCE / name
            (data / name).mkdir()
            for each in source.iterdir():
                if each.name != "quality":
                    (data / name / each.name).symlink_to(each)
        (data / "configs/quality").mkdir()
        os.mkfifo(data / "configs/quality/default.json")
        return data

    def start_waiting_gallery(self, processors=None, **environment):
        data = self.data_with_a_gate_of_its_own()
        process = subprocess.Popen([TOOL, "view", "out", "-o", "gallery", "--data-dir", data],
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True,
                                   preexec_fn=lambda: processors and
                                   os.sched_setaffinity(0, processors),
                                   env={**os.environ, **environment})
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        return process

    def feed(self):
        """Releases one process that waits for gates; returns whether there was one."""
        try:
            end = os.open(self.folder / "data/configs/quality/default.json",
                          os.O_WRONLY | os.O_NONBLOCK)
        except OSError:
            return False
        with contextlib.suppress(BrokenPipeError), open(end, "wb") as pipe:
            pipe.write((SOURCE / "configs/quality/default.json").read_bytes())
        return True

    def wait_until(self, condition):
        deadline = time.monotonic() + 120
        while not (found := condition()):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        return found

    def children(self, process):
        path = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
        try:
            return [int(word) for word in path.read_text().split()]
        except FileNotFoundError:
            return []

    def test_a_stopped_writer_leaves_no_partial_files(self):
        self.batch(clips=("walk",))
        entry = self.entries()[0]
        self.write_entries([{**entry, "relative": f"walk{i:03}.bvh"} for i in range(120)])
        process = self.start_waiting_gallery()

        def first_page():
            self.feed()
            return list(self.folder.glob("gallery/clips/*.html"))

        self.wait_until(first_page)
        # The next pages wait, so that it cannot finish.
        process.send_signal(signal.SIGINT)
        time.sleep(0.3)

        def ended():
            self.feed()
            time.sleep(0.1)
            return process.poll() is not None

        self.wait_until(ended)
        self.assertEqual(process.returncode, 130)
        made = sorted(f.name for f in self.folder.glob("gallery/**/*") if f.is_file())
        self.assertNotIn("index.html", made)
        self.assertTrue(made)
        self.assertLess(len(made), 240)
        for name in made:
            self.assertRegex(name, r"^walk.*\.(html|png)$")
            content = (self.folder / "gallery/clips" / name).read_bytes()
            self.assertTrue(content.endswith(b"</html>\n") or b"IEND" in content[-12:], name)

    def test_it_fails_when_every_process_dies(self):
        self.batch()
        # At its end the leak checker starts a child process, and hangs if that is killed.
        options = ":".join(filter(None, [os.environ.get("ASAN_OPTIONS"), "detect_leaks=0"]))
        process = self.start_waiting_gallery(ASAN_OPTIONS=options)

        def ended():
            for child in self.children(process):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(child, signal.SIGKILL)
            return process.poll() is not None

        self.wait_until(ended)
        messages = process.stderr.read()
        self.assertEqual(process.returncode, 1, messages)
        self.assertIn("no page could be created", messages)
        self.assertFalse((self.folder / "gallery/index.html").exists())

    def test_links_skip_a_page_that_failed(self):
        self.batch(clips=("walk", "squat", "wave"))
        # On one processor there is one process at a time.
        process = self.start_waiting_gallery(processors=[min(os.sched_getaffinity(0))])
        gates = self.folder / "data/configs/quality/default.json"

        def waiting():
            """Returns the other end of the pipe as soon as a process reads it."""
            with contextlib.suppress(OSError):
                return os.open(gates, os.O_WRONLY | os.O_NONBLOCK)

        end = self.wait_until(waiting)
        # Later processes need not wait.
        ready = self.write("ready.json", (SOURCE / "configs/quality/default.json").read_bytes())
        os.replace(self.folder / ready, gates)
        os.kill(self.children(process)[0], signal.SIGKILL)
        os.close(end)
        self.wait_until(lambda: process.poll() is not None)
        self.assertEqual(process.returncode, 0, process.stderr.read())
        clips = self.index()["clips"]
        self.assertIn("its page could not be created", [clip.get("message") for clip in clips])
        for clip in clips:
            self.assertTrue((self.folder / "gallery" / clip["page"]).is_file(), clip)

    @unittest.skipIf(is_sanitized(), "sanitizers take address space beyond any bound")
    def test_memory_is_bounded(self):
        self.batch(clips=("walk",))
        process = self.start_waiting_gallery()
        child = self.wait_until(lambda: self.children(process))[0]
        limits = pathlib.Path(f"/proc/{child}/limits")
        # The bound applies first in a new process.
        self.wait_until(lambda: "unlimited" not in re.search("Max data size +(.+)",
                                                             limits.read_text())[1].split()[0])

        def ended():
            self.feed()
            return process.poll() is not None

        self.wait_until(ended)


if __name__ == "__main__":
    unittest.main()
