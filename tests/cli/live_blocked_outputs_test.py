"""retarget live with receivers that block, go away or have no room: the other outputs go on, and Ctrl-C ends the run."""

import json
import os
import resource
import select
import signal
import socket
import subprocess
import threading
import time
import unittest

from live_test import LiveTest
from tool import TOOL, is_sanitized, processor_time, sample, unwrapped

PROMPT = 20.0 if is_sanitized() else 3.0  # seconds that an end may take on a busy machine


class Receiver:
    """A UDP receiver that records arrival times of robot frames."""

    def __init__(self, test):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 24)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.1)
        self.times, self.frames, self.ended = [], [], False
        self.thread = threading.Thread(target=self.receive, daemon=True)
        self.thread.start()
        test.addCleanup(self.close)

    @property
    def address(self):
        return f"udp:{self.socket.getsockname()[1]}"

    def receive(self):
        while not self.ended:
            try:
                line = self.socket.recv(65536)
            except TimeoutError:
                continue
            if b'"frame"' in line:
                self.times.append(time.monotonic())
                self.frames.append(json.loads(line)["frame"])

    def close(self):
        self.ended = True
        self.thread.join()
        self.socket.close()


class BlockedOutputs(LiveTest):
    def setUp(self):
        super().setUp()
        self.packets = [line.encode() for line in self.played("lines", "walk").splitlines()]

    def start_beside(self, *outputs, fps=50, more=(), **options):
        """A live run to a UDP receiver and other outputs, and a sender of 30 frames a second that continues until the end."""
        self.receiver = Receiver(self)
        self.start_run("-o", ",".join([self.receiver.address, *map(str, outputs)]), "--fps", fps, *more,
                       **options)

    def start_run(self, *arguments, **options):
        options.setdefault("stdout", subprocess.DEVNULL)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.process = subprocess.Popen(
            [TOOL, "live", "--robot", "unitree_g1", "--input", f"udp:{port}", *map(str, arguments)], cwd=self.folder,
            text=True, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, **options)
        self.addCleanup(self.process.stderr.close)
        self.addCleanup(self.process.wait)
        self.addCleanup(self.process.kill)
        self.lines = []
        self.reader = threading.Thread(target=lambda: self.lines.extend(self.process.stderr), daemon=True)
        self.reader.start()
        self.wait_for(lambda: "listening" in "".join(self.lines) or self.process.poll() is not None)
        sender = threading.Thread(target=self.send, args=(port,), daemon=True)
        sender.start()
        self.addCleanup(sender.join)
        self.addCleanup(self.process.kill)

    def send(self, port):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            i, begin = 0, time.monotonic()
            while self.process.poll() is None:
                frame = json.loads(self.packets[1 + i % (len(self.packets) - 1)])
                frame["time"] = i / 30  # The clock continues when the clip restarts.
                packets = [json.dumps(frame).encode()]
                if i % 30 == 0:  # The first one may be sent before the run listens.
                    packets.insert(0, self.packets[0])
                try:
                    for packet in packets:
                        sender.sendto(packet, ("127.0.0.1", port))
                except OSError:
                    pass
                i += 1
                time.sleep(max(0.0, begin + i / 30 - time.monotonic()))

    def wait_for(self, what, seconds=30):
        until = time.monotonic() + seconds
        while not what():
            self.assertLess(time.monotonic(), until, self.messages())
            time.sleep(0.02)

    def messages(self):
        return unwrapped("".join(self.lines))

    def interrupt(self, code=0):
        """Sends one Ctrl-C, waits for the prompt end, and returns the messages."""
        self.assertIsNone(self.process.poll(), self.messages())
        began = time.monotonic()
        self.process.send_signal(signal.SIGINT)
        try:
            self.process.wait(PROMPT)
        except subprocess.TimeoutExpired:
            self.fail(f"the run did not end within {time.monotonic() - began:.1f} s of Ctrl-C")
        self.reader.join(10)
        self.assertEqual(self.process.returncode, code, self.messages())
        return self.messages()

    def assert_goes_on(self, seconds=1.0, silence=0.5):
        """Asserts that the receiver gets consecutive robot frames."""
        count = len(self.receiver.frames)
        time.sleep(seconds)
        frames, times = self.receiver.frames[count:], self.receiver.times[count:]
        self.assertIsNone(self.process.poll(), self.messages())
        self.assertGreater(len(frames), 20 * seconds, self.messages())
        if not is_sanitized():
            self.assertLess(max(b - a for a, b in zip(times, times[1:])), silence)

    def test_a_tcp_receiver_that_does_not_read(self):
        with socket.socket() as listener:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            listener.bind(("127.0.0.1", 0))
            listener.listen(1)
            self.start_beside(f"tcp:{listener.getsockname()[1]}", fps=500)
            connection, _ = listener.accept()
            with connection:
                self.wait_for(lambda: "more than a second behind" in self.messages())
                self.assert_goes_on()
                # The reader receives whole frames, with gaps between them.
                lines, text, until = [], b"", time.monotonic() + 2.0
                connection.settimeout(1.0)
                while time.monotonic() < until:
                    text += connection.recv(65536)
                lines = text.split(b"\n")[:-1]
                self.assertIn(b"unitree_g1", lines[0])
                frames = [json.loads(line)["frame"] for line in lines[1:]]
                self.assertEqual(frames, sorted(set(frames)))
                self.assertGreater(len(frames), 100)
                self.assertGreater(max(b - a for a, b in zip(frames, frames[1:])), 1)
                messages = self.interrupt()
        self.assertIn("accepts robot frames again", messages)
        self.assertRegex(messages, r"output +tcp:\S+: \d+ sent, \d+ dropped")

    def test_ctrl_c_with_a_receiver_that_does_not_read(self):
        with socket.socket() as listener:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            listener.bind(("127.0.0.1", 0))
            listener.listen(1)
            self.start_run("-o", f"tcp:{listener.getsockname()[1]}", "--fps", 500)
            connection, _ = listener.accept()
            with connection:
                self.wait_for(lambda: "more than a second behind" in self.messages())
                self.interrupt()

    def test_reconnects_to_a_tcp_receiver(self):
        with socket.create_server(("127.0.0.1", 0)) as listener:
            self.start_beside(f"tcp:{listener.getsockname()[1]}")
            for visit in range(3):
                connection, _ = listener.accept()
                with connection, connection.makefile("rb") as lines:
                    # Each connection begins with the line of joint names.
                    self.assertIn("joints", json.loads(lines.readline()))
                    frames = [json.loads(lines.readline())["frame"] for _ in range(20)]
                    self.assertEqual(frames, list(range(frames[0], frames[0] + 20)), visit)
                self.assert_goes_on(0.3)
            messages = self.interrupt()
        self.assertRegex(messages, r"\d+ sent, \d+ dropped, [23] reconnects")

    def test_sleeping_reader_of_standard_output(self):
        self.start_beside("-", fps=200, stdout=subprocess.PIPE)
        self.addCleanup(self.process.stdout.close)
        self.wait_for(lambda: "standard output does not accept robot frames: it is too slow" in self.messages())
        self.assert_goes_on()
        self.interrupt()
        # The reader finds whole lines later.
        lines = self.process.stdout.read().splitlines()
        self.assertGreater(len([json.loads(line) for line in lines]), 20)

    def test_vanished_reader_of_standard_output(self):
        self.start_beside("-", stdout=subprocess.PIPE)
        self.process.stdout.readline()
        self.process.stdout.close()
        self.wait_for(lambda: "standard output no longer accepts robot frames" in self.messages())
        self.assert_goes_on()
        self.interrupt()

    def test_a_run_ends_with_its_only_reader(self):
        self.start_run("-o", "-", stdout=subprocess.PIPE)
        self.process.stdout.readline()
        self.process.stdout.close()
        self.assertEqual(self.process.wait(20), 0, self.messages())

    def test_a_pipe_without_a_reader(self):
        os.mkfifo(self.folder / "pipe")
        self.assert_fails(self.run_tool("live", "--robot", "unitree_g1", "--input", "udp:0", "-o", "pipe"), 1,
                          "no process is reading this pipe")
        reader = os.open(self.folder / "pipe", os.O_RDONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, reader)
        self.start_beside("pipe", fps=200)
        self.wait_for(lambda: "pipe does not accept robot frames: it is too slow" in self.messages())
        self.assert_goes_on()
        self.interrupt()

    def limited(self):
        """Runs in the child process: limits files to 30,000 bytes, like a full disk."""
        resource.setrlimit(resource.RLIMIT_FSIZE, (30000, 30000))

    def test_a_full_disk_does_not_stop_another_output(self):
        self.start_beside("live.csv", preexec_fn=self.limited)
        self.wait_for(lambda: "live.csv no longer accepts robot frames" in self.messages())
        self.assert_goes_on()
        messages = self.interrupt(code=1)
        self.assertRegex(messages, r"live.csv: error: \d+ robot frames could not be written: File too large")
        # No row is truncated.
        text = (self.folder / "live.csv").read_text()
        self.assertTrue(text.endswith("\n"))
        self.assertEqual({line.count(",") for line in text.splitlines()}, {35})

    def test_a_run_ends_with_its_only_disk(self):
        self.start_run("-o", "live.jsonl", preexec_fn=self.limited)
        self.assertEqual(self.process.wait(20), 1, self.messages())
        self.reader.join(10)
        self.assertIn("live.jsonl no longer accepts robot frames: File too large", self.messages())
        frames = [json.loads(line) for line in (self.folder / "live.jsonl").read_text().splitlines()]
        self.assertEqual([frame["frame"] for frame in frames[1:]], list(range(len(frames) - 1)))

    def test_a_full_device(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("there is no /dev/full")
        self.start_beside("/dev/full")
        self.wait_for(lambda: "/dev/full no longer accepts robot frames: No space left on device" in self.messages())
        self.assert_goes_on()
        self.interrupt(code=1)

    def test_a_recording_on_a_full_disk(self):
        self.start_beside(more=("--record", "kept"), preexec_fn=self.limited)
        self.wait_for(lambda: "input.stream stops here: File too large" in self.messages())
        self.assert_goes_on()
        self.interrupt(code=1)
        # The partial recording can be replayed.
        self.assert_done(self.run_tool("live", "--replay", "kept", "-o", "again.jsonl"))
        self.assertGreater(len((self.folder / "again.jsonl").read_text().splitlines()), 5)

    def full_pipe(self):
        """Returns the writing end of a full pipe without an active reader."""
        reads, takes = os.pipe()
        self.addCleanup(os.close, reads)
        self.addCleanup(os.close, takes)
        os.set_blocking(takes, False)
        with self.assertRaises(BlockingIOError):
            while True:
                os.write(takes, bytes(512))
        os.set_blocking(takes, True)
        return takes

    def assert_runs_beside(self, *arguments, **options):
        """Checks that a live run sends robot frames and ends with Ctrl-C; does not read its messages."""
        receiver = Receiver(self)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.process = subprocess.Popen(
            [TOOL, "live", "--robot", "unitree_g1", "--input", f"udp:{port}", "-o", receiver.address, *arguments],
            cwd=self.folder, stdin=subprocess.DEVNULL, **options)
        sender = threading.Thread(target=self.send, args=(port,), daemon=True)
        self.addCleanup(self.process.wait)
        self.addCleanup(self.process.kill)
        self.lines = []
        sender.start()
        self.addCleanup(sender.join)
        self.addCleanup(self.process.kill)
        self.wait_for(lambda: receiver.frames)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
            stranger.sendto(b"{}", ("127.0.0.1", port))  # This packet is reported.
        self.wait_for(lambda: len(receiver.frames) > 150)
        self.process.send_signal(signal.SIGINT)
        self.assertEqual(self.process.wait(PROMPT), 0)

    def test_messages_that_are_not_read(self):
        takes = self.full_pipe()
        self.assert_runs_beside(stdout=subprocess.DEVNULL, stderr=takes)

    def test_statistics_that_are_not_read(self):
        takes = self.full_pipe()
        self.assert_runs_beside("--stats", "-", stdout=takes, stderr=subprocess.DEVNULL)

    def test_a_player_without_a_reader_ends_at_ctrl_c(self):
        with socket.socket() as listener:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            listener.bind(("127.0.0.1", 0))
            listener.listen(1)
            self.write("walk.bvh", self.long_walk())
            player = self.start("--play", "walk.bvh", "--to", f"tcp:{listener.getsockname()[1]}", "--speed", 0)
            connection, _ = listener.accept()
            with connection:
                self.wait_until_blocked(player)
                player.send_signal(signal.SIGINT)
                self.assertEqual(player.wait(PROMPT), 0)

    def wait_until_blocked(self, process):
        """Waits until the process uses no processor time for a second."""
        before = None
        while before != processor_time(process.pid):
            before = processor_time(process.pid)
            time.sleep(1.0)
            self.assertIsNone(process.poll())

    def long_walk(self):
        """Repeats the sample until no socket buffer can hold it."""
        head, rows = sample("walk").read_text().split("Frame Time:")
        rows = rows.splitlines()
        count = int(head.rsplit("Frames:", 1)[1])
        head = head.rsplit("Frames:", 1)[0] + f"Frames: {20 * count}\n"
        return head + "Frame Time:" + rows[0] + "\n" + "\n".join(rows[1:] * 20) + "\n"


class Pipes(LiveTest):
    """With a pipe as input, readers have no deadline and nothing is lost."""

    def test_a_slow_reader_gets_every_frame(self):
        self.write("input.txt", self.played("lines"))
        with open(self.folder / "input.txt") as stream:
            process = subprocess.Popen([TOOL, "live", "-q", "--robot", "unitree_g1"], cwd=self.folder, stdin=stream,
                                       stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.addCleanup(process.stdout.close)
        time.sleep(3.0)
        frames = [json.loads(line)["frame"] for line in process.stdout.read().splitlines()[1:]]
        self.assertEqual(process.wait(20), 0)
        self.assertGreater(len(frames), 200)
        self.assertEqual(frames, list(range(len(frames))))

    def test_ctrl_c_with_a_sleeping_reader(self):
        self.write("input.txt", self.played("lines"))
        with open(self.folder / "input.txt") as stream:
            process = subprocess.Popen([TOOL, "live", "-q", "--robot", "unitree_g1", "--fps", "500"], cwd=self.folder,
                                       stdin=stream, stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.addCleanup(process.stdout.close)
        select.select([process.stdout], [], [], 20)
        time.sleep(1.0)
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(PROMPT), 0)


if __name__ == "__main__":
    unittest.main()
