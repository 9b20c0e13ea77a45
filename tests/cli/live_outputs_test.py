"""retarget live to controllers: SONIC's messages by ZeroMQ and TWIST2's keys in Redis, read by others' programs and
computed anew from the same run's JSON lines."""

import collections
import ctypes
import ctypes.util
import json
import math
import re
import shutil
import signal
import socket
import struct
import subprocess
import threading
import time
import unittest
import xml.etree.ElementTree

from live_test import LiveTest
from optional_numpy import numpy
from tool import SOURCE, absent, is_sanitized, sample, short_clip, unwrapped

SERVER = shutil.which("redis-server") or shutil.which("valkey-server")
CLIENT = shutil.which("redis-cli") or shutil.which("valkey-cli")
HEADER = 1280
FPS = 50
KEYS = ("action_body_unitree_g1_with_hands", "action_hand_left_unitree_g1_with_hands",
        "action_hand_right_unitree_g1_with_hands", "action_neck_unitree_g1_with_hands", "t_action")


class Subscriber:
    """ZeroMQ's SUB socket: pyzmq's if it is installed, else the system's library without any code of ours."""

    def __init__(self, test, port):
        endpoint = f"tcp://127.0.0.1:{port}"
        try:
            import zmq
        except ImportError:
            library = ctypes.util.find_library("zmq")
            if not library:
                absent("there is neither pyzmq nor libzmq")
            self.open_library(test, ctypes.CDLL(library), endpoint)
            return
        context = zmq.Context()
        made = context.socket(zmq.SUB)
        test.addCleanup(context.destroy, linger=0)
        made.setsockopt(zmq.SUBSCRIBE, b"pose")
        made.setsockopt(zmq.RCVTIMEO, 500)
        made.connect(endpoint)

        def receive():
            try:
                return made.recv()
            except zmq.Again:
                return None
        self.receive = receive

    def open_library(self, test, library, endpoint):
        """zmq.h of version 4: SUB is 2, SUBSCRIBE 6, RCVTIMEO 27, LINGER 17."""
        for name in ("zmq_ctx_new", "zmq_socket"):
            getattr(library, name).restype = ctypes.c_void_p
        context = ctypes.c_void_p(library.zmq_ctx_new())
        made = ctypes.c_void_p(library.zmq_socket(context, 2))
        test.addCleanup(library.zmq_ctx_term, context)
        test.addCleanup(library.zmq_close, made)
        library.zmq_setsockopt(made, 6, b"pose", ctypes.c_size_t(4))
        for option, value in ((27, 500), (17, 0)):
            library.zmq_setsockopt(made, option, ctypes.byref(ctypes.c_int(value)), ctypes.c_size_t(4))
        test.assertEqual(library.zmq_connect(made, endpoint.encode()), 0)
        room = ctypes.create_string_buffer(1 << 20)

        def receive():
            size = library.zmq_recv(made, room, ctypes.c_size_t(len(room)), 0)
            return room.raw[:size] if size >= 0 else None
        self.receive = receive


def fields_of(test, message):
    """Returns the arrays of a message, according to the documented header."""
    test.assertEqual(message[:4], b"pose")
    text, _, rest = message[4:4 + HEADER].partition(b"\0")
    test.assertEqual(rest.strip(b"\0"), b"")
    header = json.loads(text)
    test.assertEqual((header["v"], header["endian"]), (1, "le"))
    found, begin = {}, 4 + HEADER
    for field in header["fields"]:
        letter = {"f32": "f", "f64": "d", "i32": "i", "i64": "q"}[field["dtype"]]
        count = math.prod(field["shape"])
        numbers = struct.unpack_from(f"<{count}{letter}", message, begin)
        begin += count * struct.calcsize(letter)
        found[field["name"]] = numpy.reshape(numbers, field["shape"])
    test.assertEqual(begin, len(message))
    return found


def breadth_first_joints(robot):
    """Names of the hinges of a model, level by level of its tree of bodies with hinges: Isaac Lab's order."""
    root = xml.etree.ElementTree.parse(SOURCE / "robots" / robot / "model.xml").getroot()
    levels = collections.defaultdict(list)

    def walk(body, depth):
        for joint in body.findall("joint"):
            if joint.get("type", "hinge") == "hinge":
                levels[depth].append(joint.get("name"))
        for child in body.findall("body"):
            walk(child, depth + bool(child.findall("joint")))
    walk(root.find("worldbody"), 0)
    return [name for depth in sorted(levels) for name in levels[depth]]


def matrix(q):
    """Returns the rotation matrix of a unit quaternion w x y z."""
    w, x, y, z = q
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def rotation_vector(turn):
    """Returns the rotation vector of a rotation below half a turn."""
    axis = numpy.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    sine = numpy.linalg.norm(axis)
    angle = math.atan2(sine, (numpy.trace(turn) - 1) / 2)
    return axis * (angle / sine if sine > 1e-12 else 1.0)


def twist2_body(frame, before):
    """The 35 numbers of TWIST2's controller for a JSON line's frame and the one before it."""
    now, then = matrix(frame["root_rotation"]), matrix(before["root_rotation"])
    moved = numpy.subtract(frame["root_position"], before["root_position"])
    velocity = now.T @ moved * FPS
    turning = now.T @ rotation_vector(now @ then.T) * FPS
    roll, pitch = math.atan2(now[2, 1], now[2, 2]), math.asin(-now[2, 0])
    return [velocity[0], velocity[1], frame["root_position"][2], roll, pitch, turning[2], *frame["joints"]]


class OutputTest(LiveTest):
    """A live run with outputs for third-party readers."""

    def setUp(self):
        super().setUp()
        if numpy is None:
            absent("there is no numpy")
        self.formats = self.run_tool("live", "--list").stdout

    def need(self, library):
        if f"this build lacks {library}" in self.formats:
            absent(f"this build lacks {library}")

    def run_beside(self, *arguments, robot="unitree_g1"):
        """Starts a live run that also writes JSON lines; returns the ports in its messages and a function that ends
        the run and returns the messages."""
        process = self.start("--robot", robot, "--input", "udp:0?format=bvh", "--skeleton", sample("walk"),
                             "-o", "frames.jsonl", *arguments)
        ports, self.lines = {}, []
        for line in process.stderr:
            found = re.search(r"(listening|publishing) at \w+:127\.0\.0\.1:(\d+)", line)
            if found:
                ports[found.group(1)] = int(found.group(2))
            if "listening" in ports:
                break
        reader = threading.Thread(target=lambda: self.lines.extend(process.stderr), daemon=True)
        reader.start()

        def finish():
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(60), 0, self.lines)
            reader.join(10)
            return unwrapped("".join(self.lines))
        return ports, finish

    def play(self, port, frames=150):
        self.write("short.bvh", short_clip("walk", frames))
        self.assert_done(self.run_tool("live", "--play", "short.bvh", "--to", f"udp:{port}?format=bvh"))

    def frames(self):
        """Returns the joint names and the sent frames."""
        header, *lines = (self.folder / "frames.jsonl").read_text().splitlines()
        return json.loads(header)["joints"], [json.loads(line) for line in lines]

    def wait_for(self, what, seconds=20):
        until = time.monotonic() + seconds
        while not what():
            self.assertLess(time.monotonic(), until, "".join(self.lines))
            time.sleep(0.02)


class Sonic(OutputTest):
    def messages(self, output, robot="unitree_g1"):
        """The messages that a subscriber received; the joints and frames of the run."""
        self.need("ZeroMQ")
        ports, finish = self.run_beside("-o", output, robot=robot)
        subscriber = Subscriber(self, ports["publishing"])
        time.sleep(0.5)  # A subscription takes time; it misses earlier messages.
        taken, ended = [], threading.Event()

        def take():
            while (message := subscriber.receive()) is not None or not ended.is_set():
                taken.extend([message] if message else [])
        thread = threading.Thread(target=take)
        thread.start()
        self.play(ports["listening"])
        self.messages_told = finish()
        ended.set()
        thread.join(30)
        return taken, *self.frames()

    def check(self, message, joints, frames, count):
        """Compares a message with the JSON lines of the same frames."""
        fields = fields_of(self, message)
        self.assertEqual({name: fields[name].shape for name in ("joint_pos", "joint_vel", "body_quat", "frame_index")},
                         {"joint_pos": (count, 29), "joint_vel": (count, 29), "body_quat": (count, 4),
                          "frame_index": (count,)})
        order = [joints.index(name) for name in breadth_first_joints("unitree_g1")]
        for row, index in enumerate(fields["frame_index"]):
            frame = frames[index]
            self.assertEqual(frame["frame"], index)
            positions = numpy.array(frame["joints"])[order]
            before = numpy.array(frames[max(0, index - 1)]["joints"])[order]
            self.assertTrue(numpy.array_equal(fields["joint_pos"][row], positions.astype("<f4")))
            self.assertTrue(numpy.array_equal(fields["joint_vel"][row], ((positions - before) * FPS).astype("<f4")))
            self.assertTrue(numpy.array_equal(fields["body_quat"][row],
                                              numpy.array(frame["root_rotation"]).astype("<f4")))
        return fields

    def test_messages_are_the_frames_that_left(self):
        messages, joints, frames = self.messages("zmq:0?format=sonic")
        self.assertGreater(len(messages), 150)
        firsts = [self.check(message, joints, frames, 5)["frame_index"][0] for message in messages]
        self.assertEqual(firsts, list(range(firsts[0], firsts[0] + len(firsts))))
        self.assertEqual(firsts[-1] + 4, len(frames) - 1, "the last frame is lost")

    def test_hands_and_single_frames(self):
        messages, joints, frames = self.messages("zmq:0?frames=1", robot="unitree_g1_with_hands")
        self.assertGreater(len(messages), 150)
        fields = self.check(messages[-1], joints, frames, 1)
        self.assertEqual(fields["left_hand_joints"].shape, (7,))
        for side, fingers in (("left", "middle index"), ("right", "index middle")):
            names = [f"{side}_hand_{finger}_{i}_joint" for finger, count in
                     [("thumb", 3), *((finger, 2) for finger in fingers.split())] for i in range(count)]
            expected = [frames[-1]["joints"][joints.index(name)] for name in names]
            self.assertTrue(numpy.array_equal(fields[f"{side}_hand_joints"], numpy.array(expected).astype("<f4")))

    def test_rejects_unsupported_requests(self):
        def run(robot, output, *arguments):
            return self.run_tool("live", "--robot", robot, "-o", output, *arguments)
        self.need("ZeroMQ")
        self.assert_fails(run("unitree_h1", "zmq:0"), 2, "SONIC reads the 29 joints", "unitree_g1")
        self.assert_fails(run("unitree_g1", "zmq:0", "--fps", "30"), 2, "50 frames per second")
        self.assert_fails(run("unitree_g1", "zmq:0?frames=0"), 2, "1 to 100")
        self.assert_fails(run("unitree_g1", "zmq:0?frame=1"), 2, "frames")
        self.assert_fails(run("unitree_g1", "zmq:0?format=jsonl"), 2, "sonic")
        self.assert_fails(run("unitree_g1", "udp:1?format=sonic"), 2, "zmq:")
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            self.assert_fails(run("unitree_g1", f"zmq:{taken.getsockname()[1]}"), 1, "cannot bind the port")

    def test_binds_to_this_machine_alone(self):
        self.need("ZeroMQ")
        ports, finish = self.run_beside("-o", "zmq:0")
        with open("/proc/net/tcp") as table:
            places = [line.split()[1] for line in table if f":{ports['publishing']:04X} " in line]
        self.assertEqual(places, [f"0100007F:{ports['publishing']:04X}"])
        finish()

    def test_build_without_the_library_reports_it(self):
        if "this build lacks ZeroMQ" not in self.formats:
            self.skipTest("this build has ZeroMQ")
        self.assert_fails(self.run_tool("live", "--robot", "unitree_g1", "-o", "zmq:0"), 2, "this build lacks ZeroMQ")


class Redis(OutputTest):
    def start_server(self, port=0):
        """Starts redis-server at a free port or at its former port."""
        self.need("hiredis")
        if not SERVER or not CLIENT:
            absent("there is no Redis server")
        if port == 0:
            with socket.socket() as free:
                free.bind(("127.0.0.1", 0))
                port = free.getsockname()[1]
        server = subprocess.Popen([SERVER, "--port", str(port), "--bind", "127.0.0.1", "--save", ""],
                                  cwd=self.folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        self.addCleanup(server.wait)
        self.addCleanup(server.kill)
        until = time.monotonic() + 20
        while self.ask(port, "PING") != "PONG":
            self.assertLess(time.monotonic(), until, "redis-server does not answer")
            time.sleep(0.05)
        return server, port

    def ask(self, port, *command):
        return subprocess.run([CLIENT, "-p", str(port), *command], text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, timeout=30).stdout.strip()

    def watch(self, port):
        """All requests to the server, as its MONITOR reports them, in a growing list."""
        monitor = subprocess.Popen([CLIENT, "-p", str(port), "MONITOR"], text=True,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        self.addCleanup(monitor.stdout.close)
        self.addCleanup(monitor.wait)
        self.addCleanup(monitor.kill)
        self.assertEqual(monitor.stdout.readline().strip(), "OK")
        asked = []

        def read():
            for line in monitor.stdout:
                words = re.findall(r'"([^"]*)"', line)
                if words and words[0] == "MSET":
                    asked.append(dict(zip(words[1::2], words[2::2])))
        thread = threading.Thread(target=read, daemon=True)
        thread.start()
        return asked

    def test_keys_are_the_frames_that_left(self):
        _, port = self.start_server()
        asked = self.watch(port)
        began = time.time()
        ports, finish = self.run_beside("-o", f"redis:{port}?format=twist2")
        self.play(ports["listening"])
        finish()
        _, frames = self.frames()
        self.wait_for(lambda: len(asked) >= len(frames))
        self.assertEqual(len(asked), len(frames))
        times = [int(keys["t_action"]) for keys in asked]
        self.assertEqual(times, sorted(times))
        self.assertGreaterEqual(times[0], int(1000 * began))
        self.assertLessEqual(times[-1], 1000 * time.time())
        fastest = 0.0
        for i, keys in enumerate(asked):
            self.assertEqual(sorted(keys), sorted(KEYS))
            body = json.loads(keys[KEYS[0]])
            self.assertEqual(len(body), 35)
            expected = twist2_body(frames[i], frames[max(0, i - 1)])
            self.assertLess(numpy.max(numpy.abs(numpy.subtract(body, expected))), 1e-9, f"frame {i}")
            self.assertEqual(body[6:], frames[i]["joints"])
            self.assertEqual([json.loads(keys[name]) for name in KEYS[1:4]], [[0] * 7, [0] * 7, [0] * 2])
            fastest = max(fastest, body[0])
        self.assertGreater(fastest, 0.5, "the walk goes forward, along the root's x")
        # A controller receives these values on request.
        self.assertEqual(self.ask(port, "GET", KEYS[0]), asked[-1][KEYS[0]])

    def test_a_server_that_stalls_does_not_hold_the_loop_up(self):
        server, port = self.start_server()
        asked = self.watch(port)
        ports, finish = self.run_beside("-o", f"redis:{port}")
        began = time.monotonic()
        player = threading.Thread(target=self.play, args=(ports["listening"], 240))
        player.start()
        self.wait_for(lambda: len(asked) > 20)
        server.send_signal(signal.SIGSTOP)
        self.wait_for(lambda: "does not answer" in unwrapped("".join(self.lines)))
        before = len(asked)
        time.sleep(2)
        server.send_signal(signal.SIGCONT)
        self.wait_for(lambda: len(asked) > before + 20)
        player.join()
        passed = time.monotonic() - began
        messages = finish()
        self.assertEqual(messages.count("does not accept robot frames: it does not answer"), 1, messages)
        self.assertRegex(messages, r"accepts robot frames again; \d+ frames? dropped")
        _, frames = self.frames()
        # The server delays none of them: frames leave on time.
        self.assertGreater(len(frames), FPS * min(passed, 8) * 0.8)
        worst = float(re.search(r"max ([\d.]+) ms", messages)[1])
        self.assertLess(worst, 5000 if is_sanitized() else 500)

    def test_reconnects_to_a_restarted_server(self):
        server, port = self.start_server()
        ports, finish = self.run_beside("-o", f"redis:{port}")
        player = threading.Thread(target=self.play, args=(ports["listening"], 240))
        player.start()
        self.wait_for(lambda: self.ask(port, "GET", "t_action"))
        server.kill()
        server.wait()
        self.wait_for(lambda: "does not accept robot frames" in unwrapped("".join(self.lines)))
        self.start_server(port)
        self.wait_for(lambda: "accepts robot frames again" in unwrapped("".join(self.lines)))
        player.join()
        messages = finish()
        self.assertEqual(messages.count("does not accept robot frames"), 1, messages)
        self.assertEqual(len(json.loads(self.ask(port, "GET", KEYS[0]))), 35)

    def test_refuses(self):
        self.need("hiredis")
        live = ("live", "--robot", "unitree_g1", "-o")
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            # The port is bound, but has no listener.
            self.assert_fails(self.run_tool(*live, f"redis:{free.getsockname()[1]}"), 1, "refused")
        self.assert_fails(self.run_tool(*live, "redis:6379?format=sonic"), 2, "twist2")
        self.assert_fails(self.run_tool("live", "--robot", "unitree_h1", "-o", "redis:6379"), 2, "TWIST2")

    def test_a_peer_that_is_not_a_server_is_reported(self):
        self.need("hiredis")
        with socket.create_server(("127.0.0.1", 0)) as other:
            def answer():
                while True:
                    try:
                        connection, _ = other.accept()
                    except OSError:
                        return
                    with connection:
                        connection.settimeout(1)
                        try:
                            connection.recv(65536)
                            connection.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")
                        except OSError:
                            pass
            threading.Thread(target=answer, daemon=True).start()
            ports, finish = self.run_beside("-o", f"redis:{other.getsockname()[1]}")
            self.play(ports["listening"], 60)
            messages = finish()
            other.shutdown(socket.SHUT_RDWR)
        self.assertEqual(messages.count("does not accept robot frames"), 1, messages)
        self.assertGreater(len(self.frames()[1]), 50)

    def test_build_without_the_library_reports_it(self):
        if "this build lacks hiredis" not in self.formats:
            self.skipTest("this build has hiredis")
        self.assert_fails(self.run_tool("live", "--robot", "unitree_g1", "-o", "redis:6379"), 2,
                          "this build lacks hiredis")


if __name__ == "__main__":
    unittest.main()
