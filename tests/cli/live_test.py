"""retarget live over loopback: players and receivers, files and pipes, recordings, faults."""

import json
import math
import re
import signal
import socket
import subprocess
import time
import unittest

from tool import MEGABYTE, TOOL, ToolTest, difference, is_sanitized, read_rows, sample, short_clip, unwrapped


def free_port():
    """Returns a port that is currently free."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        return taken.getsockname()[1]


class LiveTest(ToolTest):
    """Ends a live run that a test left behind."""

    texts = {}  # By the arguments of played().

    def start(self, *arguments):
        process = subprocess.Popen([TOOL, "live", *map(str, arguments)], cwd=self.folder, text=True,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def listen(self, *arguments, transport="udp", extras=""):
        """Starts a listening live run of the G1; returns it and its port."""
        process = self.start("--robot", "unitree_g1", "--input", f"{transport}:0{extras}", *arguments)
        for line in process.stderr:
            found = re.search(r"listening at \w+:127\.0\.0\.1:(\d+)", line)
            if found:
                return process, int(found.group(1))
        self.fail("the port has no listener")
        return None

    def wait_until_read(self, port, transport="udp"):
        """Waits until a live run has accepted all connections to its port and read all input."""
        def unread():
            with open(f"/proc/net/{transport}") as table:
                rows = [line.split() for line in table if f":{port:04X}" in line.split()[1]]
            return sum(int(row[4].split(":")[1], 16) for row in rows)
        until = time.monotonic() + 60
        while unread() > 0:
            self.assertLess(time.monotonic(), until, "the run does not read its input")
            time.sleep(0.01)

    def end(self, process):
        """Sends Ctrl-C, also to a stopped process, and returns the printed text."""
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGCONT)
        out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, err)
        return out, unwrapped(err)

    def played(self, form, clip="wave", speed=0):
        """Returns the text that a player sends for a sample; plays each one only once."""
        if (form, clip, speed) not in LiveTest.texts:
            result = self.run_tool("live", "--play", sample(clip), "--to", f"stdout?format={form}",
                                   "--speed", speed)
            self.assert_done(result)
            LiveTest.texts[form, clip, speed] = result.stdout
        return LiveTest.texts[form, clip, speed]

    def live(self, text, *arguments):
        """Returns the output of a live run for this standard input."""
        self.write("input.txt", text)
        with open(self.folder / "input.txt") as stream:
            return self.run_tool("live", "--robot", "unitree_g1", *arguments, stdin=stream)


class Pipes(LiveTest):
    def test_plain_frames_are_those_of_the_published_method(self):
        rows = self.played("bvh", "walk")
        offline = self.retarget("--method", "gmr", "--fps", "source", "--lead-in", "keep", bvh=sample("walk"))
        self.assert_done(offline)
        result = self.live(rows, "--input", "stdin?format=bvh&fps=30", "--skeleton", sample("walk"),
                           "--method", "gmr", "--plain", "--fps", "30", "-o", "live.csv")
        self.assert_done(result)
        found = read_rows((self.folder / "live.csv").read_text())
        expected = read_rows((self.folder / "out.csv").read_text())
        self.assertIsNone(difference(found, expected, 1e-9))

    def test_lines_carry_their_skeleton(self):
        result = self.live(self.played("lines"), "--mode", "lag", "--lag", "0.1")
        self.assert_done(result)
        lines = [json.loads(line) for line in result.stdout.splitlines()]
        self.assertEqual(lines[0]["robot"], "unitree_g1")
        self.assertEqual(len(lines[0]["joints"]), 29)
        frames = lines[1:]
        self.assertEqual([frame["frame"] for frame in frames], list(range(len(frames))))
        self.assertEqual({frame["state"] for frame in frames}, {"following"})
        self.assertAlmostEqual(frames[10]["time"] - frames[9]["time"], 0.02, places=9)
        self.assertEqual(len(frames[0]["joints"]), 29)

    def test_a_folded_zero_pose_causes_no_warnings(self):
        for form in ("lines", "bvh"):
            result = self.live(self.played(form, "walk"), "--input", f"stdin?format={form}", "-o", "live.csv")
            self.assert_done(result)
            self.assertIn("LAFAN1", result.stderr)
            self.assertNotIn("unusual", result.stderr)
            self.assertNotIn("in no frame", result.stderr)

    def test_malformed_lines_are_counted_and_reported_once(self):
        text = self.played("lines").splitlines()
        for place in (5, 50, 100):
            text.insert(place, '{"time": 1, "joints": \x1b[31m')
        result = self.live("\n".join(text) + "\n")
        self.assert_done(result)
        self.assertIn("3 malformed", result.stderr)
        self.assertEqual(result.stderr.count("skipping malformed packet"), 1)
        self.assertNotIn("\x1b[31m", result.printed)

    def test_usage(self):
        self.assertIn("bvh", self.run_tool("live", "--list").stdout)
        self.assert_fails(self.run_tool("live"), 2, "robot")
        g1 = ("live", "--robot", "unitree_g1")
        self.assert_fails(self.run_tool(*g1, "--input", "udp:x"), 2, "port")
        self.assert_fails(self.run_tool(*g1, "--input", "udp:0?format=bhv"), 2, "bvh")
        self.assert_fails(self.run_tool(*g1, "-o", "no/where.csv"), 2, "no")
        self.assert_fails(self.run_tool(*g1, "--mode", "lag", "--method", "gmr", "--skeleton", sample("walk")), 2,
                          "gmr")
        self.assert_fails(self.run_tool(*g1, "--replay", "nothing"), 4, "live.json")
        self.assert_fails(self.run_tool("live", "--play", "none.bvh"), 3, "none.bvh")

    def test_memory_does_not_grow_with_a_stream(self):
        rows = sample("walk").read_text().split("Frame Time:")[1].splitlines()[1:]
        there_and_back = rows + rows[-2:0:-1]
        peaks = []
        for seconds in (20, 160):
            frames = 50 * seconds
            # Row by row, because the peak memory of a child process starts at its parent's.
            with open(self.folder / "rows.txt", "w") as stream:
                for frame in range(frames):
                    stream.write(there_and_back[frame % len(there_and_back)] + "\n")
            with open(self.folder / "rows.txt") as stream:
                result = self.run_measured("live", "-q", "--robot", "unitree_g1", "--input",
                                           "stdin?format=bvh&fps=50", "--skeleton", sample("walk"), "--mode", "lag",
                                           "-o", "live.csv", seconds=240, stdin=stream)
            self.assertEqual(result.returncode, 0, result.stderr)
            with open(self.folder / "live.csv") as written:
                self.assertEqual(sum(1 for _ in written), frames)
            peaks.append(result.peak)
        if not is_sanitized():
            self.assertLess(peaks[1] - peaks[0], 4 * MEGABYTE, peaks)

    def test_a_stream_without_frames_is_not_an_error(self):
        result = self.live("")
        self.assert_done(result)
        self.assertIn("0 frames", result.stderr)


# Of MVN's segments: name, parent, position in the T-pose, metres, Z up, facing x.
SEGMENTS = (
    ("Pelvis", None, (0, 0, 0.95)), ("L5", 0, (0, 0, 1.05)), ("L3", 1, (0, 0, 1.15)), ("T12", 2, (0, 0, 1.25)),
    ("T8", 3, (0, 0, 1.35)), ("Neck", 4, (0, 0, 1.49)), ("Head", 5, (0, 0, 1.58)),
    ("RightShoulder", 4, (0, -0.03, 1.44)), ("RightUpperArm", 7, (0, -0.17, 1.44)),
    ("RightForeArm", 8, (0, -0.46, 1.44)), ("RightHand", 9, (0, -0.71, 1.44)),
    ("LeftShoulder", 4, (0, 0.03, 1.44)), ("LeftUpperArm", 11, (0, 0.17, 1.44)),
    ("LeftForeArm", 12, (0, 0.46, 1.44)), ("LeftHand", 13, (0, 0.71, 1.44)),
    ("RightUpperLeg", 0, (0, -0.09, 0.92)), ("RightLowerLeg", 15, (0, -0.09, 0.5)),
    ("RightFoot", 16, (0, -0.09, 0.09)), ("RightToe", 17, (0.16, -0.09, 0.02)),
    ("LeftUpperLeg", 0, (0, 0.09, 0.92)), ("LeftLowerLeg", 19, (0, 0.09, 0.5)),
    ("LeftFoot", 20, (0, 0.09, 0.09)), ("LeftToe", 21, (0.16, 0.09, 0.02)),
)


def about(axis, angle):
    """Returns a quaternion w x y z about a world axis."""
    return [math.cos(angle / 2), *(math.sin(angle / 2) if i == axis else 0.0 for i in range(3))]


def product(a, b):
    return [a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]]


def turned(q, v):
    return product(product(q, [0.0, *v]), [q[0], -q[1], -q[2], -q[3]])[1:]


def mvnx_document(frames):
    """A person who steps in place and waves, 50 frames a second, as MVN exports it."""
    def pose(turns):
        rotations, places = [], []
        for name, parent, at in SEGMENTS:
            turn = turns.get(name, [1.0, 0.0, 0.0, 0.0])
            rotations.append(turn if parent is None else product(rotations[parent], turn))
            offset = at if parent is None else [a - b for a, b in zip(at, SEGMENTS[parent][2])]
            places.append(list(offset) if parent is None else
                          [a + b for a, b in zip(places[parent], turned(rotations[parent], offset))])
        return rotations, places

    def frame(kind, turns):
        rotations, places = pose(turns)
        return (f'<frame type="{kind}"><orientation>{" ".join(str(x) for q in rotations for x in q)}</orientation>'
                f'<position>{" ".join(str(x) for p in places for x in p)}</position></frame>')

    def moving(time):
        swing = math.sin(4 * time)
        return {"Pelvis": about(2, 0.3 * time), "T8": about(1, 0.1 * swing),
                "RightUpperArm": about(0, 1.2), "LeftUpperArm": about(0, -0.9 + 0.5 * swing),
                "LeftForeArm": about(2, -0.7 * abs(swing)), "RightUpperLeg": about(1, -0.35 * max(swing, 0.0)),
                "RightLowerLeg": about(1, 0.7 * max(swing, 0.0))}

    segments = "".join(f'<segment label="{name}"/>' for name, _, _ in SEGMENTS)
    joints = "".join(f"<joint><connector1>{SEGMENTS[parent][0]}/j</connector1><connector2>{name}/j</connector2></joint>"
                     for name, parent, _ in SEGMENTS if parent is not None)
    poses = frame("tpose", {}) + "".join(frame("normal", moving(i / 50)) for i in range(frames))
    return ('<?xml version="1.0"?><mvnx version="4"><subject frameRate="50">'
            f"<segments>{segments}</segments><joints>{joints}</joints><frames>{poses}</frames></subject></mvnx>")


class BinaryFormats(LiveTest):
    """Xsens MVN and OptiTrack NatNet, from the player to the robot."""

    def motion(self, clip, form, *arguments):
        """Returns the robot motion of a clip piped in a format."""
        with open(self.folder / "played.bin", "wb") as played:
            subprocess.run([TOOL, "live", "-q", "--play", clip, "--speed", "0", "--to", f"stdout?format={form}"],
                           cwd=self.folder, check=True, stdout=played, timeout=60)
        with open(self.folder / "played.bin", "rb") as played:
            result = self.run_tool("live", "--robot", "unitree_g1", "--input", f"stdin?format={form}",
                                   "-o", "live.csv", *arguments, stdin=played)
        self.assert_done(result)
        self.assertIn(" 0 malformed", result.stderr)
        return read_rows((self.folder / "live.csv").read_text())

    def test_natnet_equals_lines(self):
        # Frames at whole milliseconds and 50 per second, like the robot's.
        self.write("walk.bvh", re.sub("Frame Time: .*", "Frame Time: 0.02", sample("walk").read_text()))
        lines = self.motion("walk.bvh", "lines")
        self.assertIsNone(difference(self.motion("walk.bvh", "natnet"), lines, 1e-4))
        # MVN's segments are those of the human in the clip: fewer joints, calibrated like any
        # skeleton.
        self.assertIsNone(difference(self.motion("walk.bvh", "mvn"), lines, 0.02))

    def test_mvn_equals_lines(self):
        self.write("steps.mvnx", mvnx_document(150))
        lines = self.motion("steps.mvnx", "lines")
        self.assertIsNone(difference(self.motion("steps.mvnx", "mvn"), lines, 1e-4))
        self.assertIsNone(difference(self.motion("steps.mvnx", "natnet"), lines, 1e-4))

    def test_a_pose_may_calibrate_mvn(self):
        self.write("steps.mvnx", mvnx_document(100))
        lines = self.motion("steps.mvnx", "lines", "--calibrate", "tpose", "--after", "0")
        mvn = self.motion("steps.mvnx", "mvn", "--calibrate", "tpose", "--after", "0")
        self.assertIsNone(difference(mvn, lines, 1e-4))

    def test_mvn_over_tcp(self):
        self.write("steps.mvnx", mvnx_document(60))
        process, port = self.listen("-o", "live.csv", transport="tcp", extras="?format=mvn")
        self.assert_done(self.run_tool("live", "--play", "steps.mvnx", "--to", f"tcp:{port}?format=mvn"))
        time.sleep(0.3)
        _, messages = self.end(process)
        self.assertRegex(messages, r" 0 malformed; frames 0 lost")
        self.assertGreater(len(read_rows((self.folder / "live.csv").read_text())), 55)

    def ask(self, command, *arguments, extras=""):
        """A NatNet run that asks a player, and its messages."""
        self.write("short.bvh", short_clip("walk", 60))
        process, port = self.listen("-o", "live.csv", *arguments,
                                    extras=f"?format=natnet&server=127.0.0.1&command={command}{extras}")
        return process, port

    def test_natnet_asks_its_server(self):
        command = free_port()
        process, port = self.ask(command, "--record", "kept")
        # Frames go elsewhere, and to clients that request them.
        self.assert_done(self.run_tool("live", "--play", "short.bvh", "--to",
                                       f"udp:{free_port()}?format=natnet&command={command}"))
        time.sleep(0.3)
        _, messages = self.end(process)
        self.assertIn(" 0 malformed; frames 0 lost", messages)
        self.assertIn("unit m", messages)
        self.assertGreater(len(read_rows((self.folder / "live.csv").read_text())), 60)
        self.assert_done(self.run_tool("live", "--replay", "kept", "-o", "again.csv"))
        self.assertEqual((self.folder / "again.csv").read_bytes(), (self.folder / "live.csv").read_bytes())
        self.assertGreater(port, 0)

    def test_natnet_names_a_server_that_does_not_answer(self):
        for has_frames in (False, True):
            command = free_port()
            process, port = self.ask(command)
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
                for _ in range(10 if has_frames else 0):
                    sender.sendto(b"\7\0\x08\0" + bytes(8), ("127.0.0.1", port))
                    time.sleep(0.02)
            time.sleep(0.3)
            _, messages = self.end(process)
            self.assertRegex(messages, "10 packets malformed; Motive" if has_frames else "no packet arrived: Motive")
            self.assertIn(f"command port 127.0.0.1:{command} does not answer", messages)

    def test_natnet_to_a_group(self):
        command, group = free_port(), free_port()
        self.write("short.bvh", short_clip("walk", 60))
        process = self.start("--robot", "unitree_g1", "-o", "live.csv", "--input",
                             f"udp:{group}?format=natnet&multicast=239.255.42.99&server=127.0.0.1&command={command}")
        self.assertIn("listening", process.stderr.readline())
        self.assert_done(self.run_tool(
            "live", "--play", "short.bvh", "--to",
            f"udp:239.255.42.99:{group}?format=natnet&command={command}&interface=127.0.0.1"))
        time.sleep(0.3)
        _, messages = self.end(process)
        self.assertRegex(messages, r" 0 malformed; frames 0 lost, 0 late, 0 doubled")
        self.assertGreater(len(read_rows((self.folder / "live.csv").read_text())), 60)

    def test_usage(self):
        g1 = ("live", "--robot", "unitree_g1", "--input")
        self.assert_fails(self.run_tool(*g1, "udp:0?format=natnet&multicast=1.2.3.4"), 2, "239.255.42.99")
        self.assert_fails(self.run_tool(*g1, "udp:0?format=natnet&server=motive"), 2, "after an IPv4 address")
        self.assert_fails(self.run_tool(*g1, "udp:0?format=natnet&server=10.0.0.1"), 2, "udp:0.0.0.0")
        self.assert_fails(self.run_tool(*g1, "udp:0?format=bvh&server=127.0.0.1"), 2, "have no server")


class Sockets(LiveTest):
    def test_player_and_receiver_over_udp(self):
        taken = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(taken.close)
        taken.bind(("127.0.0.1", 0))
        taken.settimeout(30)
        process, port = self.listen("-o", f"udp:{taken.getsockname()[1]}", "-o", "live.csv",
                                    extras="?format=bvh")
        self.write("short.bvh", short_clip("walk", 120))
        player = self.run_tool("live", "--play", "short.bvh", "--to", f"udp:{port}?format=bvh")
        self.assert_done(player)
        self.assertIn("120 of 120 frames", player.stderr)
        self.assertIn("unitree_g1", json.loads(taken.recv(65536))["robot"])
        frame = json.loads(taken.recv(65536))
        self.assertEqual(frame["frame"], 0)
        _, messages = self.end(process)
        self.assertRegex(messages, r"packets +\d+, 0 malformed")
        self.assertRegex(messages, r"latency .*p99 [\d.]+ ms")
        self.assertGreater(len(read_rows((self.folder / "live.csv").read_text())), 80)

    def test_packets_of_another_program_are_named(self):
        process, port = self.listen(extras="?format=vmc")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for _ in range(10):
                sender.sendto(b"/tracking/trackers/1/position\0\0\0,f\0\0\0\0\0\0", ("127.0.0.1", port))
        _, messages = self.end(process)
        self.assertRegex(messages, r"packets +10, 10 malformed")
        self.assertRegex(messages, r"stream +no frame of the stream is usable: 10 of 10 packets malformed, the first "
                         r"one: expected messages such as /VMC/Ext/Bone/Pos, found /tracking/trackers/1/position")

    def test_a_run_that_ends_without_a_usable_frame_fails(self):
        process, port = self.listen("--silent", "0.5", extras="?format=lines")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for _ in range(3):
                sender.sendto(b'{"hello": 1}\n', ("127.0.0.1", port))
        _, messages = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 3, messages)
        self.assertIn("no frame of the stream is usable: 3 of 3 packets malformed", unwrapped(messages))

    def test_the_format_that_packets_have_is_named(self):
        process, port = self.listen(extras="?format=smplx")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.sendto(b'{"skeleton": []}', ("127.0.0.1", port))
        _, messages = self.end(process)
        self.assertRegex(messages, r"the input looks like lines: use udp:[0-9.]+:[0-9]+\?format=lines")

    def test_a_connection_after_another(self):
        process, port = self.listen("-o", "live.csv", transport="tcp")
        text = self.played("lines")
        for _ in range(2):
            with socket.create_connection(("127.0.0.1", port)) as connection:
                connection.sendall(text.encode())
            time.sleep(0.3)
        _, messages = self.end(process)
        self.assertIn("0 malformed", messages)

    def test_binds_to_this_machine_alone(self):
        _, port = self.listen()
        with open("/proc/net/udp") as table:
            places = [line.split()[1] for line in table if f":{port:04X} " in line]
        self.assertEqual(places, [f"0100007F:{port:04X}"])

    def test_a_port_that_is_taken(self):
        _, port = self.listen()
        self.assert_fails(self.run_tool("live", "--robot", "unitree_g1", "--input", f"udp:{port}"), 1,
                          "cannot bind the port")

    def test_a_recording_gives_the_same_bytes_again(self):
        process, port = self.listen("--record", "kept", "--mode", "lag", "--lag", "0.1",
                                    "--skeleton", sample("walk"), "-o", "live.csv", extras="?format=bvh")
        self.write("short.bvh", short_clip("walk", 90))
        self.assert_done(self.run_tool("live", "--play", "short.bvh", "--to", f"udp:{port}?format=bvh"))
        time.sleep(0.5)  # The stream is paused meanwhile.
        self.end(process)
        (self.folder / "elsewhere").mkdir()
        (self.folder / "kept").rename(self.folder / "elsewhere/kept")
        replay = self.run_tool("live", "--replay", "elsewhere/kept", "-o", "again.csv", "-o", "again.jsonl")
        self.assert_done(replay)
        self.assertEqual((self.folder / "again.csv").read_bytes(), (self.folder / "live.csv").read_bytes())
        self.assertEqual((self.folder / "again.jsonl").read_bytes(),
                         (self.folder / "elsewhere/kept/output.jsonl").read_bytes())
        self.assertIn('"holding"', (self.folder / "again.jsonl").read_text())

    def test_ends_by_itself(self):
        started = time.monotonic()
        process, _ = self.listen("--seconds", "0.5")
        process.communicate(timeout=30)
        self.assertEqual(process.returncode, 0)
        self.assertLess(time.monotonic() - started, 20)


if __name__ == "__main__":
    unittest.main()
