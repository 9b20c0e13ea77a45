"""Checks the guarantees of docs/live.md in a live run in real time, with a fault every half minute.

The script streams a clip at its own rate, back and forth, to `retarget live` as `lines` over UDP. One fault begins every
`--every` seconds: a stall, a step of the sender's clock, a slow or fast sender, jitter, a burst, a replay, lost frames, a
teleport, malformed packets, a flood, non-finite values, a non-human skeleton, a second sender, a stopped
process, a TCP receiver that does not read. Robot frames are timed at the receiver. The script fails if

* the run ends,
* two robot frames are further apart than 2 / fps plus the delay of the machine (below), except while the process is
  stopped,
* a joint leaves its range, or exceeds its speed limit over a tenth of a second of wall time,
* a value is not finite,
* the robot does not follow the human again within `--recover` seconds of the end of a fault,
* memory grows by more than a megabyte after the first fifth of the run.

A second process, which otherwise sleeps, sends a heartbeat. The delay of its beats in the last second is the delay that
the machine adds to a gap. The script prints both.

    python3 bench/live_faults.py build/release/retarget data/walk.bvh --minutes 60 --lag 0.2
"""

import argparse
import collections
import json
import math
import multiprocessing
import os
import pathlib
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
FPS = 50
MEGABYTE = 1 << 20
SO_TIMESTAMPNS = 35  # Linux constant that Python does not define.
WINDOW = 0.1  # Seconds over which speeds are measured.


def udp_socket(seconds=None):
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 24)
    made.bind(("127.0.0.1", 0))
    made.settimeout(seconds)
    return made


def recorded_lines(tool, clip):
    """Returns the skeleton line and the frames of a clip, as the player sends them."""
    text = subprocess.run([tool, "live", "--play", clip, "--to", "stdout?format=lines", "--speed", "0"], check=True,
                          capture_output=True, text=True).stdout.splitlines()
    return text[0], [json.loads(line) for line in text[1:]]


def arrival(marks):
    """Returns the kernel's receive time of a packet, which excludes scheduling delays of the receiver."""
    for level, kind, data in marks:
        if level == socket.SOL_SOCKET and kind == SO_TIMESTAMPNS:
            seconds, nanoseconds = struct.unpack("qq", data[:16])
            return seconds + 1e-9 * nanoseconds
    raise RuntimeError("packets have no time of arrival: SO_TIMESTAMPNS needs Linux")


BEAT = 0.01  # seconds


def beat(port):
    """Sends a datagram every BEAT seconds; runs in a separate process."""
    own = udp_socket()
    due = time.monotonic()
    while True:
        own.sendto(b"beat", ("127.0.0.1", port))
        due += BEAT
        time.sleep(max(0.0, due - time.monotonic()))


class TcpReceiver(threading.Thread):
    """Reads the data of an output, unless paused."""

    def __init__(self):
        super().__init__(daemon=True)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.reads = threading.Event()
        self.reads.set()

    def run(self):
        while True:
            connection, _ = self.listener.accept()
            with connection:
                while self.reads.wait() and connection.recv(1 << 16):
                    pass


class Watch(threading.Thread):
    """Receives robot frames and keeps the worst value per kind."""

    def __init__(self, slack):
        super().__init__(daemon=True)
        profile = json.loads((ROOT / "robots/unitree_g1/robot.json").read_text())
        self.ranges = profile["limit_sets"]["official"]["ranges"]
        self.speeds = profile["speed_limits"]
        self.slack = slack
        self.socket = udp_socket(0.5)
        self.socket.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self.port = self.socket.getsockname()[1]
        self.joints = []
        self.frames = 0
        self.state = "waiting"
        self.stopped = False
        self.last_beat = None
        self.late_beats = collections.deque()  # arrival, seconds late
        self.recent = collections.deque()
        self.fault = "none"
        self.worst = collections.defaultdict(lambda: collections.defaultdict(float))
        self.violations = []

    def run(self):
        while True:
            try:
                packet, marks, _, _ = self.socket.recvmsg(1 << 16, 64)
            except TimeoutError:
                continue
            now = arrival(marks)
            if packet == b"beat":
                self.take_beat(now)
                continue
            for line in packet.splitlines():
                message = json.loads(line)
                if "fps" in message:
                    self.joints = message["joints"]
                else:
                    self.look_at(message, now)

    def take_beat(self, now):
        if self.last_beat is not None and now - self.last_beat > 2 * BEAT:
            self.late_beats.append((now, now - self.last_beat - BEAT))
        self.last_beat = now
        while self.late_beats and self.late_beats[0][0] < now - 1.0:
            self.late_beats.popleft()
        worst = self.worst[self.fault]
        worst["machine"] = max(worst["machine"], self.lateness(now))

    def lateness(self, now):
        """Returns the delay of the machine in the last second, including a beat that is still missing."""
        missing = now - self.last_beat - BEAT if self.last_beat is not None else 0.0
        return max([missing, 0.0, *(late for _, late in self.late_beats)])

    def note(self, figure, value, bound, unit):
        worst = self.worst[self.fault]
        worst[figure] = max(worst[figure], value)
        if value > bound and len(self.violations) < 100:
            self.violations.append(f"{self.fault}: {figure} {value:.4g} {unit}, allowed {bound:.4g}")

    def look_at(self, frame, now):
        self.frames += 1
        self.state = frame["state"]
        values = frame["root_position"] + frame["root_rotation"] + frame["joints"]
        if not all(math.isfinite(value) for value in values):
            self.violations.append(f"{self.fault}: a value is not finite")
        if self.recent:
            gap = now - self.recent[-1][0]
            if self.stopped:
                self.recent.clear()
                self.stopped = gap < 0.3  # This frame ends the pause.
            else:
                self.note("gap", gap, 2 / FPS + self.slack + self.lateness(now), "s")
        for name, angle in zip(self.joints, frame["joints"]):
            low, high = self.ranges[name]
            self.note("beyond range", max(low - angle, angle - high, 0.0), 2e-6, "rad")
        self.recent.append((now, frame["joints"]))
        while len(self.recent) > 2 and self.recent[1][0] <= now - WINDOW:
            self.recent.popleft()
        at, joints = self.recent[0]
        if now - at >= WINDOW:
            # A frame can arrive up to `slack` earlier or later than it was sent.
            share = max(abs(a - b) / ((now - at + 1 / FPS + self.slack) * self.speeds[name])
                        for name, a, b in zip(self.joints, frame["joints"], joints))
            self.note("share of speed limits", share, 1.0, "")


class Sender:
    """Streams the clip and its faults."""

    def __init__(self, skeleton, frames, port, seed):
        self.skeleton, self.frames = skeleton.encode(), frames
        described = json.loads(skeleton)["skeleton"]
        self.metres = described["unit"]
        self.level = {"y": (0, 2), "z": (0, 1)}[described["up"]]  # Horizontal axes.
        self.address = ("127.0.0.1", port)
        self.socket = udp_socket()
        self.random = random.Random(seed)
        self.period = frames[1]["time"] - frames[0]["time"]
        self.index = 0
        self.stamp = 0.0
        self.sent = collections.deque(maxlen=150)
        self.next = time.monotonic()

    def frame(self, shift=(0.0, 0.0)):
        """Returns the next line of the clip, played back and forth."""
        count = len(self.frames)
        place = self.index % (2 * count - 2)
        frame = self.frames[min(place, 2 * count - 2 - place)]
        self.index += 1
        joints = frame["joints"]
        for axis, metres in zip(self.level, shift):
            joints = {name: [value + metres / self.metres if i == axis else value for i, value in enumerate(pose)]
                      for name, pose in joints.items()}
        line = json.dumps({"time": self.stamp, "joints": joints}).encode()
        self.sent.append(line)
        return line

    def send(self, line):
        self.socket.sendto(line, self.address)

    def wait(self, rate=1.0):
        """Waits until the next frame is due. `rate` is that of the sender's clock."""
        self.stamp += self.period * rate
        self.next += self.period
        time.sleep(max(0.0, self.next - time.monotonic()))

    def play(self, seconds, rate=1.0, keep=lambda: True, shift=(0.0, 0.0), late=lambda: 0.0):
        """Sends frames for the given time."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            line = self.frame(shift)
            if keep():
                delay = late()
                if delay > 0.0:
                    threading.Timer(delay, self.send, (line,)).start()
                else:
                    self.send(line)
            self.wait(rate)

    def pause(self, seconds):
        time.sleep(seconds)
        self.stamp += seconds
        self.next = time.monotonic()


class Faults:
    """Each method is one fault and returns when the fault is over."""

    def __init__(self, sender, process, receiver, watch, chosen):
        self.sender, self.process, self.receiver, self.watch = sender, process, receiver, watch
        self.chosen = chosen

    def stall_of_3_s(self):
        self.sender.pause(3.0)

    def stall_of_half_a_second(self):
        self.sender.pause(0.5)

    def clock_steps_a_little(self):
        self.sender.stamp += self.sender.random.choice((-0.15, 0.15))

    def clock_steps_far(self):
        self.sender.stamp += self.sender.random.choice((-10.0, -5.0, 5.0, 10.0))

    def slow_sender(self):
        self.sender.play(8.0, rate=0.9)

    def fast_sender(self):
        self.sender.play(8.0, rate=1.05)

    def jitter(self):
        self.sender.play(6.0, late=lambda: abs(self.sender.random.gauss(0.0, 0.03)))

    def delay_step(self):
        self.sender.play(6.0, late=lambda: 0.15)

    def burst(self):
        held = []
        end = time.monotonic() + 0.6
        while time.monotonic() < end:
            held.append(self.sender.frame())
            self.sender.wait()
        for line in held:
            self.sender.send(line)

    def replay(self):
        for line in list(self.sender.sent):
            self.sender.send(line)

    def lost_frames(self):
        self.sender.play(6.0, keep=lambda: self.sender.random.random() > 0.4)

    def teleport(self):
        self.sender.play(3.0, shift=(3.0, -2.0))

    def malformed_packets(self):
        for _ in range(60):
            line = self.sender.frame()
            self.sender.send(line[:self.sender.random.randrange(len(line))])
            self.sender.send(self.sender.random.randbytes(700))
            self.sender.send(line)
            self.sender.wait()

    def flood(self):
        end = time.monotonic() + 2.0
        while time.monotonic() < end:
            for _ in range(40):
                self.sender.send(b"{}\n" * 60)
            self.sender.send(self.sender.frame())
            self.sender.wait()

    def not_finite(self):
        for _ in range(30):
            line = re.sub(rb"\[[-0-9.e]+,", b"[NaN,", self.sender.frame(), count=3)
            self.sender.send(line)
            self.sender.wait()

    def skeleton_without_human(self):
        self.sender.send(b'{"skeleton": {"joints": [{"name": "a", "parent": null, "rest": [0, 0, 1, 1, 0, 0, 0]}, '
                         b'{"name": "b", "parent": "a", "rest": [0, 0, 2, 1, 0, 0, 0]}]}}')
        self.sender.play(1.0)
        self.sender.send(self.sender.skeleton)

    def second_sender(self):
        other = udp_socket()
        for _ in range(90):
            other.sendto(self.sender.skeleton, self.sender.address)
            self.sender.send(self.sender.frame())
            other.sendto(self.sender.frame((1.0, 1.0)), self.sender.address)
            self.sender.wait()

    def stopped_process(self):
        self.watch.stopped = True
        self.process.send_signal(signal.SIGSTOP)
        self.sender.play(1.5)
        self.process.send_signal(signal.SIGCONT)

    def blocked_receiver(self):
        self.receiver.reads.clear()
        self.sender.play(8.0)
        self.receiver.reads.set()

    def all(self):
        names = self.chosen or sorted(name for name in vars(Faults) if not name.startswith("_") and name != "all")
        return [getattr(self, name) for name in names]


def listening_port(process):
    for line in process.stderr:
        found = re.search(r"listening at \S+:(\d+)", line)
        if found:
            threading.Thread(target=process.stderr.read, daemon=True).start()
            return int(found.group(1))
    raise RuntimeError("the live run ended before it listened")


def resident(process):
    pages = int(pathlib.Path(f"/proc/{process.pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / MEGABYTE


def attack(arguments, sender, faults, watch, process):
    """Plays the clip and injects faults. Returns the values of recovery and memory."""
    kinds, late = [], []
    begin = time.monotonic()
    memory = []
    while time.monotonic() < begin + 60 * arguments.minutes and process.poll() is None:
        watch.fault = "none"
        sender.play(max(0.0, arguments.every - arguments.recover))
        memory.append((time.monotonic() - begin, resident(process)))
        if not kinds:
            kinds = faults.all()
            sender.random.shuffle(kinds)
        fault = kinds.pop()
        watch.fault = fault.__name__
        fault()
        ended = time.monotonic()
        followed = None
        while time.monotonic() < ended + arguments.recover and process.poll() is None:
            sender.play(0.1)
            if watch.state != "following":
                followed = None
            elif followed is None:
                followed = time.monotonic() - ended
        watch.worst[watch.fault]["follows after"] = max(watch.worst[watch.fault]["follows after"],
                                                        followed if followed is not None else math.inf)
        if followed is None:
            late.append(f"{watch.fault}: the robot is still {watch.state}")
    return late, memory


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tool")
    parser.add_argument("clip")
    parser.add_argument("--minutes", type=float, default=5.0)
    parser.add_argument("--lag", type=float, help="of the live run, seconds; without: frame by frame")
    parser.add_argument("--every", type=float, default=30.0, help="seconds from fault to fault, besides their own")
    parser.add_argument("--recover", type=float, default=4.0, help="seconds of regular frames after which the robot must follow")
    parser.add_argument("--slack", type=float, default=0.005, help="seconds by which a gap may be longer than 2 / fps on a machine that is never late")
    parser.add_argument("--faults", default="", help="names of methods of Faults, separated by commas; without: all")
    parser.add_argument("--record", help="a folder for recordings of all input and output (retarget live --replay)")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    mode = ["--mode", "lag", "--lag", str(arguments.lag)] if arguments.lag is not None else ["--mode", "frame"]
    skeleton, frames = recorded_lines(arguments.tool, arguments.clip)
    chosen = [name for name in arguments.faults.split(",") if name]
    receiver, watch = TcpReceiver(), Watch(arguments.slack)
    receiver.start()
    watch.start()
    heart = multiprocessing.Process(target=beat, args=(watch.port,), daemon=True)
    heart.start()
    process = subprocess.Popen(
        [arguments.tool, "live", "--robot", "unitree_g1", "--fps", str(FPS), "--input", "udp:0?format=lines", *mode,
         *(["--record", arguments.record] if arguments.record else []),
         "-o", f"udp:{watch.port},tcp:127.0.0.1:{receiver.port}"], stderr=subprocess.PIPE, text=True)
    try:
        sender = Sender(skeleton, frames, listening_port(process), arguments.seed)
        sender.send(sender.skeleton)
        late, memory = attack(arguments, sender, Faults(sender, process, receiver, watch, chosen), watch, process)
        alive = process.poll() is None
    finally:
        process.kill()
        process.wait()
    for name, worst in sorted(watch.worst.items()):
        print(f"{name:24}" + "  ".join(f"{figure} {value:.3g}" for figure, value in sorted(worst.items())))
    failures = watch.violations + late
    if not alive:
        failures.append(f"the run ended with {process.returncode}")
    settled = memory[len(memory) // 5:]
    growth = settled[-1][1] - settled[0][1] if settled else 0.0
    print(f"{watch.frames} robot frames, memory {growth:+.2f} MB since the first fifth, {len(failures)} violations")
    if growth > 1.0:
        failures.append(f"memory grew by {growth:.2f} MB")
    sys.exit("\n".join(failures) or 0)


if __name__ == "__main__":
    main()
