"""Measures the time from a packet to its robot frame over loopback, compared with a plain echo.

One run sends, 50 times a second, a row of a clip to `retarget live`, which returns a robot frame, and the same bytes to
an echo, which returns them unchanged. Both are separate processes, so each path has one packet in and one out. The
echo is a few lines of Python, or a program: --echo build/release/bench/udp_echo (bench/udp_echo.cpp).

    python3 bench/live_latency.py build/release/tools/retarget/retarget data/walk.bvh --seconds 60
"""

import argparse
import pathlib
import re
import socket
import statistics
import subprocess
import sys
import time

ECHO = """
import socket
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.bind(("127.0.0.1", 0))
print(s.getsockname()[1], flush=True)
while True:
    bytes_in, sender = s.recvfrom(65536)
    s.sendto(bytes_in, sender)
"""


def receiver() -> socket.socket:
    """Opens a socket at a free port of this machine."""
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.bind(("127.0.0.1", 0))
    return made


def drained(taken: socket.socket) -> None:
    """Discards earlier packets."""
    taken.setblocking(False)
    try:
        while True:
            taken.recv(65536)
    except BlockingIOError:
        taken.settimeout(0.015)


def next_frame(taken: socket.socket) -> None:
    """Waits for a robot frame and skips header lines, which are repeated now and then."""
    while taken.recv(65536).startswith(b'{"robot"'):
        pass


def text_of(times: list[float]) -> str:
    """Formats percentiles in milliseconds."""
    times = sorted(times)
    return "  ".join(f"{name} {1e3 * times[min(len(times) - 1, int(share * len(times)))]:.3f} ms"
                     for name, share in (("p50", 0.5), ("p99", 0.99), ("max", 1.0)))


def main() -> None:
    """Sends rows and measures the delays."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tool")
    parser.add_argument("clip", type=pathlib.Path)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--lag", type=float, help="of the live run, seconds; without: frame by frame")
    parser.add_argument("--echo", help="a program that prints its port and sends datagrams back; without: Python")
    arguments = parser.parse_args()
    mode = ["--mode", "lag", "--lag", str(arguments.lag)] if arguments.lag is not None else ["--mode", "frame"]
    text = arguments.clip.read_text()
    rows = text[text.index("Frame Time:"):].splitlines()[1:]
    back = receiver()
    live = subprocess.Popen([arguments.tool, "live", "--robot", "unitree_g1", "--input", "udp:0?format=bvh&fps=50",
                             "--skeleton", arguments.clip, *mode, "-o", f"udp:{back.getsockname()[1]}"],
                            stderr=subprocess.PIPE, text=True)
    echo = subprocess.Popen([arguments.echo] if arguments.echo else [sys.executable, "-c", ECHO], stdout=subprocess.PIPE, text=True)
    try:
        port = 0
        for line in live.stderr:
            found = re.search(r"listening at \S+:(\d+)", line)
            if found:
                port = int(found.group(1))
                break
        echo_port = int(echo.stdout.readline())
        own = receiver()
        own.settimeout(0.5)
        there, here = [], []
        begin = time.perf_counter()
        for i in range(int(50 * arguments.seconds)):
            # Play the clip back and forth, like a performer who repeats two seconds of walking.
            place = i % (2 * len(rows) - 2)
            row = rows[min(place, 2 * len(rows) - 2 - place)].encode()
            time.sleep(max(0.0, begin + i / 50 - time.perf_counter()))
            drained(back)
            sent = time.perf_counter()
            own.sendto(row, ("127.0.0.1", port))
            try:
                next_frame(back)
                there.append(time.perf_counter() - sent)
            except TimeoutError:
                pass  # The window is still filling.
            sent = time.perf_counter()
            own.sendto(row, ("127.0.0.1", echo_port))
            own.recv(65536)
            here.append(time.perf_counter() - sent)
        warm = 100  # Exclude the first frames, in which solver and windows start up.
        print(f"live   {text_of(there[warm:])}  ({len(there)} of {len(here)} packets)")
        print(f"echo   {text_of(here[warm:])}")
        print(f"median above the echo {1e3 * (statistics.median(there[warm:]) - statistics.median(here[warm:])):.3f} ms")
    finally:
        live.terminate()
        echo.terminate()
        print(live.stderr.read(), end="")


if __name__ == "__main__":
    main()
