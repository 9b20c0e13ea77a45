"""retarget live under floods: packets of little size and much work cost the sender's frames at most, never a robot frame."""

import ctypes
import ctypes.util
import pathlib
import re
import socket
import threading
import time
import unittest

from live_blocked_outputs_test import Receiver
from live_test import LiveTest
from tool import is_sanitized, processor_time

SILENCE = 5.0 if is_sanitized() else 0.3  # seconds without a robot frame, on a busy machine
PROCESSOR = 0.15 # of its time, for everything


def lz4_frame(text):
    """Compresses with the system's library; None without it."""
    name = ctypes.util.find_library("lz4")
    if not name:
        return None
    library, size = ctypes.CDLL(name), ctypes.c_size_t
    library.LZ4F_compressFrameBound.restype = library.LZ4F_compressFrame.restype = size
    library.LZ4F_compressFrameBound.argtypes = [size, ctypes.c_void_p]
    library.LZ4F_compressFrame.argtypes = [ctypes.c_void_p, size, ctypes.c_char_p, size, ctypes.c_void_p]
    room = ctypes.create_string_buffer(library.LZ4F_compressFrameBound(len(text), None))
    count = library.LZ4F_compressFrame(room, len(room), text, len(text), None)
    return room.raw[:count]


def waits_of_other_threads(process):
    """Returns how often the threads besides the one that reads packets have waited for something."""
    tasks = pathlib.Path(f"/proc/{process.pid}/task")
    texts = [(task / "status").read_text() for task in tasks.iterdir() if task.name != str(process.pid)]
    return sum(int(re.search(r"\nvoluntary_ctxt_switches:\s*(\d+)", text)[1]) for text in texts)


class Floods(LiveTest):
    def attack(self, form, flood, every=0.01):
        """A clip, and among its packets, from the same address, others: at most how long no robot frame leaves."""
        packets = [line.encode() + b"\n" for line in self.played(form, "walk").splitlines()]
        receiver = Receiver(self)
        process, port = self.listen("-o", receiver.address, extras=f"?format={form}")
        ended = threading.Event()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            def send_flood():
                while not ended.wait(every):
                    sender.sendto(flood, ("127.0.0.1", port))
            begin, thread = time.monotonic(), threading.Thread(target=send_flood)
            for i, packet in enumerate(packets[:150]):
                sender.sendto(packet, ("127.0.0.1", port))
                if i == 60:
                    thread.start()
                    began, used = time.monotonic(), processor_time(process.pid)
                    waits, frames = waits_of_other_threads(process), len(receiver.times)
                time.sleep(max(0.0, begin + (i + 1) / 30 - time.monotonic()))
            waits = (waits_of_other_threads(process) - waits) / (len(receiver.times) - frames)
            share = (processor_time(process.pid) - used) / (time.monotonic() - began)
            ended.set()
            thread.join()
        times = receiver.times
        self.assertGreater(len(times), 150)
        self.assertLess(max(b - a for a, b in zip(times, times[1:])), SILENCE)
        # Packets without frames do not wake the thread of robot frames.
        self.assertLess(waits, 10, "per robot frame")
        if not is_sanitized():
            self.assertLess(share, PROCESSOR)
        return self.end(process)[1]

    def test_bombs_of_lz4(self):
        bomb = lz4_frame(b'{"a":[' + b"0," * (1 << 18) + b"0]}")
        if bomb is None:
            self.skipTest("there is no liblz4")
        self.attack("rokoko", bomb * (60000 // len(bomb)))

    def test_empty_objects(self):
        messages = self.attack("rokoko", b"{}" * 32000)
        self.assertIn("malformed", messages)

    def test_empty_lines(self):
        self.attack("lines", b"{}\n" * 21000)

    def test_nested_lists(self):
        self.attack("lines", b"[" * 60000 + b"\n", every=0.002)

    def test_small_packets(self):
        self.attack("lines", b"{}", every=0.0002)


if __name__ == "__main__":
    unittest.main()
