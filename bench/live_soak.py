"""Checks a live run over minutes or hours: no lost frames, no growth of memory or of time per frame.

The script sends rows of a clip, back and forth, to `retarget live` one by one and reads the robot frames, as fast as
possible or 50 times a second. The run is divided into tenths. The first two are the beginning, in which windows fill and
the solver's buffers reach their size. The script fails if

* the numbers of robot frames and rows differ,
* the resident memory after the beginning and at the end differs by more than a megabyte,
* the processor time per frame in the last tenths exceeds that after the beginning by half.

Wall-clock times are printed but not checked, because other programs affect them.

    python3 bench/live_soak.py build/release/tools/retarget/retarget data/walk.bvh --lag 0.2 --minutes 60 --real-time
"""

import argparse
import ctypes
import os
import pathlib
import select
import statistics
import subprocess
import sys
import time

FPS = 50
TENTHS = 10
BEGINNING = 2  # tenths
MEGABYTE = 1 << 20
MOST_GROWTH = 1.0  # megabytes
MOST_SLOWER = 1.5


class LiveRun:
    """A run that reads BVH rows from one pipe and writes robot frames to another."""

    def __init__(self, tool, clip, mode, patience):
        self.patience = patience
        self.process = subprocess.Popen(
            [tool, "live", "--robot", "unitree_g1", "--input", f"stdin?format=bvh&fps={FPS}",
             "--skeleton", clip, "--fps", str(FPS), *mode],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        os.set_blocking(self.process.stdout.fileno(), False)
        self.rest = b""
        self.frames = -1  # The first line is a header.
        self.held = 0

    def send(self, row):
        self.process.stdin.write(row)
        self.process.stdin.flush()

    def take(self, seconds):
        """Counts frames that arrive within the given time. Returns False without any."""
        if not select.select([self.process.stdout], [], [], seconds)[0]:
            return False
        got = self.process.stdout.read(1 << 20)
        if not got:
            return False
        self.frames += got.count(b"\n")
        self.held += got.count(b'"holding"') + got.count(b'"standing"')
        return True

    def wait_for(self, frames):
        """Waits for this number of frames. Returns whether they have arrived."""
        while self.frames < frames:
            if not self.take(self.patience):
                return False
        return True

    def resident(self):
        """Returns the resident memory in bytes."""
        pages = int(pathlib.Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE")

    def processor_time(self):
        """Returns the processor time in seconds, with nanosecond resolution.

        The hundredths of a second of /proc are as long as some hundred frames.
        """
        clock = ctypes.c_int()
        if ctypes.CDLL(None).clock_getcpuclockid(self.process.pid, ctypes.byref(clock)) != 0:
            raise RuntimeError("the processor time of the run is unavailable")
        return time.clock_gettime(clock.value)


def rows_of(clip):
    """Yields the rows of a clip back and forth, without end."""
    text = clip.read_text()
    rows = [row.encode() + b"\n" for row in text[text.index("Frame Time:"):].splitlines()[1:] if row.strip()]
    while True:
        yield from rows
        yield from rows[-2:0:-1]


def soak(run, rows, count, delay, real_time):
    """Sends each row after the frame that the previous row completes, `delay` frames earlier, has arrived.

    If other processes delay the rows, the stream stalls and the robot is held for the missing frames. Returns values
    for each tenth.
    """
    sent = 0
    tenths = []
    for tenth in range(TENTHS):
        times, processor, began = [], run.processor_time(), time.perf_counter()
        frames = range(sent, sent + count // TENTHS)
        for i in frames:
            if real_time:
                time.sleep(max(0.0, began + (i - frames.start) / FPS - time.perf_counter()))
            row = next(rows)
            now = time.perf_counter()
            run.send(row)
            sent += 1
            if not run.wait_for(sent - delay):
                raise RuntimeError(f"after {sent} rows there are {run.frames} frames")
            times.append(time.perf_counter() - now)
        times.sort()
        figures = {"p50": times[len(times) // 2], "p99": times[int(0.99 * len(times))], "max": times[-1],
                   "cpu": (run.processor_time() - processor) / len(times), "rss": run.resident()}
        tenths.append(figures)
        print(f"{tenth + 1:3} of {TENTHS}: {sent} rows  p50 {1e3 * figures['p50']:.3f} ms  "
              f"p99 {1e3 * figures['p99']:.3f} ms  max {1e3 * figures['max']:.3f} ms  "
              f"processor {1e3 * figures['cpu']:.3f} ms a frame  memory {figures['rss'] / MEGABYTE:.2f} MB", flush=True)
    run.process.stdin.close()
    while run.process.poll() is None or run.take(0.0):
        run.take(0.1)
    return sent, tenths


def main():
    """Runs the test and checks the results."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tool")
    parser.add_argument("clip", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, default=3.0, help="of motion (default %(default)s)")
    parser.add_argument("--lag", type=float, help="of the live run, seconds; without: frame by frame")
    parser.add_argument("--real-time", action="store_true", help="50 rows a second; without: as fast as it goes")
    parser.add_argument("--patience", type=float, default=60.0, help="seconds after which a frame counts as lost")
    parser.add_argument("--any-memory", action="store_true", help="do not judge memory, as of a sanitizer's")
    arguments = parser.parse_args()
    mode = ["--mode", "lag", "--lag", str(arguments.lag)] if arguments.lag is not None else ["--mode", "frame"]
    run = LiveRun(arguments.tool, arguments.clip, mode, arguments.patience)
    try:
        sent, tenths = soak(run, rows_of(arguments.clip), int(60 * FPS * arguments.minutes),
                            round(FPS * (arguments.lag or 0.0)), arguments.real_time)
    finally:
        run.process.kill()
        run.process.wait()
    faults = []
    if run.frames != sent:
        faults.append(f"{run.frames} frames of {sent} rows")
    growth = (tenths[-1]["rss"] - tenths[BEGINNING - 1]["rss"]) / MEGABYTE
    if growth > MOST_GROWTH and not arguments.any_memory:
        faults.append(f"memory has grown by {growth:.2f} MB")
    early = statistics.mean(tenth["cpu"] for tenth in tenths[BEGINNING:BEGINNING + 3])
    late = statistics.mean(tenth["cpu"] for tenth in tenths[-3:])
    if late > MOST_SLOWER * early:
        faults.append(f"a frame takes {1e3 * late:.3f} ms, after {1e3 * early:.3f} ms at first")
    print(f"{run.frames} frames of {sent} rows, {run.held} held; memory {growth:+.2f} MB, processor time {late / early - 1:+.1%} since "
          "the beginning")
    sys.exit("; ".join(faults) or 0)


if __name__ == "__main__":
    main()
