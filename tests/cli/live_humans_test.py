"""Streams of bones of their own (VMC, Rokoko, SMPL): other people's receivers and senders, and the same robot."""

import json
import socket
import sys
import time
import unittest

from live_recordings import RecordingTest
from live_test import LiveTest
from optional_numpy import numpy
from tool import SOURCE, absent, difference, read_rows, sample, short_clip

# Third-party clients installed by tools/setup.sh --python.
sys.path.append(str(SOURCE / "build/deps/python"))
try:  # From PyPI: python-osc.
    from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
    from pythonosc.osc_message_builder import OscMessageBuilder
    from pythonosc.osc_packet import OscPacket
except ImportError:
    OscPacket = None
try:
    from vmcp import events as vmc_events
except ImportError:
    vmc_events = None
try:
    import lz4.frame as lz4_frame
except ImportError:
    lz4_frame = None


def turned(q, v):
    """Rotates a vector by a quaternion x y z w."""
    x, y, z, w = q
    uv = (y * v[2] - z * v[1], z * v[0] - x * v[2], x * v[1] - y * v[0])
    uuv = (y * uv[2] - z * uv[1], z * uv[0] - x * uv[2], x * uv[1] - y * uv[0])
    return [v[i] + 2 * (w * uv[i] + uuv[i]) for i in range(3)]


def product(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


# HumanBodyBones of a VRM avatar and their parents.
PARENTS = {"Hips": None, "Spine": "Hips", "Chest": "Spine", "UpperChest": "Chest", "Neck": "UpperChest",
           "Head": "Neck"}
for _side in ("Left", "Right"):
    PARENTS |= {_side + "Shoulder": "UpperChest", _side + "UpperArm": _side + "Shoulder",
                _side + "LowerArm": _side + "UpperArm", _side + "Hand": _side + "LowerArm",
                _side + "UpperLeg": "Hips", _side + "LowerLeg": _side + "UpperLeg",
                _side + "Foot": _side + "LowerLeg", _side + "Toes": _side + "Foot"}


class Vmc(RecordingTest):
    def received(self, frames):
        """Returns the player's packets for the first frames of a sample."""
        taken = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(taken.close)
        taken.bind(("127.0.0.1", 0))
        taken.settimeout(30)
        self.write("short.bvh", short_clip("walk", frames))
        player = self.run_tool("live", "--play", "short.bvh", "--to", f"udp:{taken.getsockname()[1]}?format=vmc",
                               "--speed", "4")
        self.assert_done(player)
        return [taken.recv(65536) for _ in range(frames)]

    def need_clients(self):
        if OscPacket is None or vmc_events is None:
            absent("python-osc or vmcp is missing: tools/setup.sh --python")

    def test_other_receivers_read_played_streams(self):
        self.need_clients()
        times = []
        for packet in self.received(40):
            messages = [timed.message for timed in OscPacket(packet).messages]
            self.assertEqual(messages[0].address, "/VMC/Ext/OK")
            self.assertEqual(messages[0].params, [1])
            self.assertEqual(messages[1].address, "/VMC/Ext/T")
            times.append(messages[1].params[0])
            self.assertEqual(messages[2].address, "/VMC/Ext/Root/Pos")
            self.assertEqual(messages[2].params, ["root", 0, 0, 0, 0, 0, 0, 1])
            bones = {message.params[0]: message.params[1:] for message in messages[3:]}
            self.assertEqual({message.address for message in messages[3:]}, {"/VMC/Ext/Bone/Pos"})
            self.assertEqual(set(bones), set(PARENTS))
            self.assert_is_walker(bones)
        self.assertEqual(len(times), 40)
        for a, b in zip(times, times[1:]):
            self.assertAlmostEqual(b - a, 1 / 30, places=5)

    def assert_is_walker(self, bones):
        """Whether the avatar that hangs from these bones walks upright in Unity's world, left-handed and y up."""
        at, turn = {}, {}
        for bone, parent in PARENTS.items():
            place, rotation = bones[bone][:3], bones[bone][3:]
            self.assertAlmostEqual(sum(x * x for x in rotation), 1.0, places=5)
            if parent is None:
                at[bone], turn[bone] = place, tuple(rotation)
            else:
                moved = turned(turn[parent], place)
                at[bone] = [at[parent][i] + moved[i] for i in range(3)]
                turn[bone] = product(turn[parent], rotation)
        self.assertLess(abs(min(at["LeftToes"][1], at["RightToes"][1])), 0.08)
        self.assertGreater(at["Head"][1], at["Hips"][1] + 0.5)
        # A body without rotations faces z, and its right is x.
        right, ahead = turned(turn["Hips"], (1, 0, 0)), turned(turn["Hips"], (0, 0, 1))
        for bone in ("Hand", "Foot", "UpperArm"):
            across = [at["Right" + bone][i] - at["Left" + bone][i] for i in range(3)]
            self.assertGreater(sum(a * b for a, b in zip(across, right)), 0.1)
        for side in ("Left", "Right"):
            foot = [at[side + "Toes"][i] - at[side + "Foot"][i] for i in range(3)]
            self.assertGreater(sum(a * b for a, b in zip(foot, ahead)), 0.03)

    def test_vmcp_knows_every_message(self):
        self.need_clients()
        kinds = {kind.ADDRESS_PATTERN: kind
                 for kind in (vmc_events.StateEvent, vmc_events.RelativeTimeEvent, vmc_events.RootTransformEvent,
                              vmc_events.BoneTransformEvent)}
        for packet in self.received(3):
            for timed in OscPacket(packet).messages:
                message = timed.message
                event = kinds[message.address].from_message_data("test", message.address, tuple(message.params))
                if message.address == "/VMC/Ext/Bone/Pos":
                    self.assertEqual(event.joint.value, message.params[0])

    def test_another_sender_is_followed(self):
        self.need_clients()
        process, port = self.listen("-o", "live.csv", extras="?format=vmc")
        places = {"Hips": (0, 0.95, 0), "Spine": (0, 0.1, 0), "Chest": (0, 0.12, 0), "UpperChest": (0, 0.12, 0),
                  "Neck": (0, 0.15, 0), "Head": (0, 0.1, 0)}
        for side, sign in (("Left", -1), ("Right", 1)):
            places |= {side + "Shoulder": (0.03 * sign, 0.1, 0), side + "UpperArm": (0.13 * sign, 0, 0),
                       side + "LowerArm": (0.28 * sign, 0, 0), side + "Hand": (0.25 * sign, 0, 0),
                       side + "UpperLeg": (0.09 * sign, -0.05, 0), side + "LowerLeg": (0, -0.42, 0),
                       side + "Foot": (0, -0.4, 0), side + "Toes": (0, -0.06, 0.12)}
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for frame in range(60):
                bundle = OscBundleBuilder(IMMEDIATELY)
                values = [("/VMC/Ext/T", [frame / 60.0])]
                values += [("/VMC/Ext/Bone/Pos", [bone, *map(float, place), 0.0, 0.0, 0.0, 1.0])
                           for bone, place in places.items()]
                for address, arguments in values:
                    message = OscMessageBuilder(address)
                    for argument in arguments:
                        message.add_arg(argument)
                    bundle.add_content(message.build())
                sender.sendto(bundle.build().dgram, ("127.0.0.1", port))
                time.sleep(1 / 60)
        _, messages = self.end(process)
        self.assertIn("0 malformed", messages)
        self.assertGreater(len(read_rows((self.folder / "live.csv").read_text())), 40)

    def test_the_robot_is_that_of_lines(self):
        self.write("short.bvh", short_clip("walk", 60))
        found = {}
        for form in ("lines", "vmc"):
            process, port = self.listen("--record", form, "--height", "1.75", "--fps", "30", "--plain",
                                        extras=f"?format={form}")
            self.assert_done(self.run_tool("live", "--play", "short.bvh", "--to", f"udp:{port}?format={form}"))
            self.end(process)
            # The machine's load changes which times the robot frames have, so the packets arrive again on time.
            self.assertEqual(self.regular_times(form), 60)
            self.assert_done(self.run_tool("live", "--replay", form, "-o", f"{form}.jsonl"))
            found[form] = self.followed(f"{form}.jsonl")
        both = sorted(found["lines"].keys() & found["vmc"].keys())
        self.assertGreater(len(both), 55)
        for number in both:
            lines, vmc = (found[form][number]["joints"] for form in ("lines", "vmc"))
            self.assertLess(max(abs(a - b) for a, b in zip(lines, vmc)), 1e-3, number)


class Pipes(LiveTest):
    def rows_of(self, form, *arguments):
        result = self.live(self.played(form), "--input", f"stdin?format={form}", "--height", "1.75", "-o", "live.csv",
                           *arguments)
        self.assert_done(result)
        self.assertIn("0 malformed", result.stderr)
        return read_rows((self.folder / "live.csv").read_text())

    def test_the_robot_is_that_of_lines(self):
        expected = self.rows_of("lines")
        for form in ("rokoko", "smplx"):
            with self.subTest(form):
                self.assertIsNone(difference(self.rows_of(form), expected, 1e-3))

    def test_options_of_recognition_serve_the_player(self):
        self.assert_fails(self.run_tool("live", "--play", sample("walk"), "--to", "stdout?format=vmc", "--map",
                                        "none.json"), 4, "none.json")


class Rokoko(LiveTest):
    def test_malformed_packets_and_other_actors(self):
        packets = self.played("rokoko").splitlines()
        other = json.loads(packets[40])
        other["scene"]["actors"][0]["name"] = "second actor"
        packets[40] = json.dumps(other)
        packets[50] = packets[50].replace('"head"', '"haed"')
        packets.insert(60, '{"scene": \x1b[31m}')
        process, port = self.listen("-o", "live.csv", extras="?format=rokoko&actor=retarget")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for packet in packets[:90]:
                sender.sendto(packet.encode(), ("127.0.0.1", port))
                self.wait_until_read(port)
        _, messages = self.end(process)
        self.assertIn("3 malformed", messages)
        self.assertIn("second actor", messages)
        self.assertNotIn("\x1b[31m", messages)

    @unittest.skipIf(lz4_frame is None, "lz4 is missing")
    def test_compressed_by_another_program(self):
        text = self.played("rokoko")
        frames = [lz4_frame.compress(packet.encode()) for packet in text.splitlines()]
        process, port = self.listen("-o", "live.csv", transport="tcp", extras="?format=rokoko")
        with socket.create_connection(("127.0.0.1", port)) as connection:
            for frame in frames:
                connection.sendall(frame)
            self.wait_until_read(port, "tcp")
        time.sleep(0.5)
        _, messages = self.end(process)
        if "this build lacks" in messages:
            self.skipTest("built without LZ4")
        self.assertIn("0 malformed", messages)
        self.assertGreater(len(read_rows((self.folder / "live.csv").read_text())), 200)


@unittest.skipIf(numpy is None, "numpy is missing")
class Smpl(LiveTest):
    def test_plain_frames_are_those_of_the_same_file(self):
        frames = numpy.arange(90) / 30.0
        poses = numpy.zeros((90, 165))
        poses[:, 0] = 0.5 * numpy.pi  # Upright in a world with z up.
        poses[:, 3] = 0.4 * numpy.sin(2 * frames)
        poses[:, 6] = -0.4 * numpy.sin(2 * frames)
        poses[:, 12] = 0.3 + 0.3 * numpy.cos(2 * frames)
        poses[:, 16 * 3 + 2] = -1.2 + 0.3 * numpy.sin(3 * frames)
        poses[:, 17 * 3 + 2] = 1.2 + 0.3 * numpy.sin(3 * frames)
        poses[:, 18 * 3 + 1] = -0.8
        trans = numpy.stack([0.3 * frames, 0 * frames, 0.95 + 0 * frames], axis=1)
        numpy.savez(self.folder / "walk.npz", poses=poses, trans=trans, betas=numpy.array([0.5]),
                    mocap_frame_rate=30.0, gender="neutral")
        offline = self.run_tool("--smpl", "walk.npz", "--robot", "unitree_g1", "--method", "gmr", "--fps", "source",
                                "--lead-in", "keep", "-o", "out.csv")
        self.assert_done(offline)
        expected = read_rows((self.folder / "out.csv").read_text())
        lines = [json.dumps({"time": i / 30.0, "betas": [0.5], "transl": trans[i].tolist(),
                             "global_orient": poses[i, :3].tolist(), "body_pose": poses[i, 3:66].tolist(),
                             "left_hand_pose": poses[i, 75:120].tolist()}) for i in range(90)]
        played = self.run_tool("live", "--play", "walk.npz", "--to", "stdout?format=smplx", "--speed", 0)
        self.assert_done(played)
        # The motion determines the up axis; a single pose does not.
        header = self.run_tool("live", "--play", "walk.npz", "--to", "stdout?format=lines", "--speed", 0)
        self.assertEqual(json.loads(header.stdout.splitlines()[0])["skeleton"]["up"], "z")
        for text in ("\n".join(lines) + "\n", played.stdout):
            result = self.live(text, "--input", "stdin?format=smplx", "--skeleton", "walk.npz", "--method", "gmr",
                               "--plain", "--fps", "30", "-o", "live.csv")
            self.assert_done(result)
            self.assertIn("0 malformed", result.stderr)
            found = read_rows((self.folder / "live.csv").read_text())
            self.assertIsNone(difference(found, expected, 1e-6))


if __name__ == "__main__":
    unittest.main()
