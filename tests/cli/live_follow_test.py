"""--follow arms: the operator of a stream walks and turns, the robot's legs and base stand, its arms do as before."""

import json
import math
import shutil
import socket
import struct
import unittest

from live_recordings import RecordingTest
from live_test import product, turned
from tool import read_rows, sample, short_clip

ARMS = [f"{side}_{joint}_joint" for side in ("left", "right") for joint in (
    "shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow", "wrist_roll", "wrist_pitch", "wrist_yaw")]
FRAMES = 90


def walk_at(seconds):
    """Returns the pose of an operator on a circle: heading, metres ahead and to the left."""
    return 0.8 * seconds, 1.5 * math.sin(0.6 * seconds), 1.5 - 1.5 * math.cos(0.6 * seconds)


def walking_smpl(text):
    """Returns `smplx` lines of a walking operator with the same arm motion; z up."""
    lines = text.splitlines()
    for i, line in enumerate(lines):
        frame = json.loads(line)
        if "transl" not in frame:
            continue
        turn, ahead, left = walk_at(frame["time"])
        q = [math.cos(turn / 2), 0, 0, math.sin(turn / 2)]
        vector = frame["global_orient"]
        angle = math.sqrt(sum(x * x for x in vector))
        scale = math.sin(angle / 2) / angle if angle > 1e-9 else 0.5
        w, *rest = product(q, [math.cos(angle / 2), *(scale * x for x in vector)])
        sine = math.sqrt(sum(x * x for x in rest))
        factor = 2 * math.atan2(sine, w) / sine if sine > 1e-9 else 2
        frame["global_orient"] = [factor * x for x in rest]
        moved = turned(q, frame["transl"])
        frame["transl"] = [moved[0] + ahead, moved[1] + left, moved[2]]
        lines[i] = json.dumps(frame)
    return "\n".join(lines) + "\n"


def walking_vmc(packet, seconds):
    """A packet of VMC with the avatar's root moved; Unity's axes, y up."""
    root = b"/VMC/Ext/Root/Pos\0\0\0,sfffffff\0\0\0root\0\0\0\0"
    begin = packet.index(root) + len(root)
    turn, ahead, left = walk_at(seconds)
    pose = struct.pack(">7f", -left, 0, ahead, 0, math.sin(turn / 2), 0, math.cos(turn / 2))
    return packet[:begin] + pose + packet[begin + len(pose):]


class Follow(RecordingTest):
    def assert_arms_alone(self, rows, names):
        """Asserts that only the arms move."""
        held = [i for i, name in enumerate(names) if name not in ARMS]
        self.assertEqual(len(held), len(names) - len(ARMS))
        for row in rows:
            self.assertEqual(row["root_position"], rows[0]["root_position"])
            self.assertEqual(row["root_rotation"], [1, 0, 0, 0])
            self.assertEqual([row["joints"][i] for i in held], [0] * len(held))
        spans = [max(row["joints"][i] for row in rows) - min(row["joints"][i] for row in rows)
                 for i, name in enumerate(names) if name in ARMS]
        self.assertGreater(max(spans), 0.3)

    def test_smpl(self):
        found = []
        text = self.played("smplx")
        for lines in (text, walking_smpl(text)):
            result = self.live(lines, "--input", "stdin?format=smplx", "--follow", "arms", "--height", "1.75",
                               "-o", "live.jsonl")
            self.assert_done(result)
            self.assertIn("0 malformed", result.stderr)
            self.assertIn("14 joints of the arms", result.stderr)
            header, *rows = map(json.loads, (self.folder / "live.jsonl").read_text().splitlines())
            self.assertEqual(header["held"][:2], ["root_position", "root_rotation"])
            self.assertEqual(set(header["held"][2:]), set(header["joints"]) - set(ARMS))
            self.assert_arms_alone(rows, header["joints"])
            found.append([row["joints"] for row in rows])
        self.assertEqual(len(found[0]), len(found[1]))
        # Robot frames between those of a turning human are interpolated along chords.
        for standing, walking in zip(*found):
            self.assertLess(max(abs(a - b) for a, b in zip(standing, walking)), 1e-3)

    def vmc(self, packets):
        """Returns the robot frames of packets that arrive 30 times a second, by their numbers."""
        process, port = self.listen("--follow", "arms", "--plain", "--fps", "30", "--record", "kept",
                                    extras="?format=vmc")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for packet in packets:
                sender.sendto(packet, ("127.0.0.1", port))
                self.wait_until_read(port)
        _, messages = self.end(process)
        self.assertIn("0 malformed", messages)
        # The machine's load changes when packets arrive, so they arrive again on time.
        self.assertEqual(self.regular_times("kept"), len(packets))
        self.assert_done(self.run_tool("live", "--replay", "kept", "-o", "live.jsonl"))
        shutil.rmtree(self.folder / "kept")
        header, *rows = map(json.loads, (self.folder / "live.jsonl").read_text().splitlines())
        self.assert_arms_alone(rows, header["joints"])
        return self.followed("live.jsonl")

    def test_vmc(self):
        taken = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(taken.close)
        taken.bind(("127.0.0.1", 0))
        taken.settimeout(30)
        self.write("short.bvh", short_clip("wave", FRAMES))
        # Read during playback: a socket buffer holds fewer packets.
        self.start("-q", "--play", "short.bvh", "--to", f"udp:{taken.getsockname()[1]}?format=vmc", "--speed", "4")
        packets = [taken.recv(65536) for _ in range(FRAMES)]
        standing = self.vmc(packets)
        walking = self.vmc([walking_vmc(packet, i / 30) for i, packet in enumerate(packets)])
        both = sorted(standing.keys() & walking.keys())
        self.assertGreater(len(both), FRAMES - 5)
        for number in both:
            pairs = zip(standing[number]["joints"], walking[number]["joints"])
            self.assertLess(max(abs(a - b) for a, b in pairs), 1e-3, number)

    def test_offline(self):
        for method in ("fit", "gmr"):
            result = self.run_tool("--bvh", sample("walk"), "--robot", "unitree_g1", "--follow", "arms", "--method",
                                   method, "-o", f"{method}.csv")
            self.assert_done(result)
            self.assertIn("14 joints of the arms", result.stderr)
            rows = read_rows((self.folder / f"{method}.csv").read_text())
            self.assertGreater(len(rows), 100)
            # The columns of the root (7), the legs (12) and the waist (3).
            self.assertEqual({tuple(row[:7]) for row in rows}, {tuple(rows[0][:7])})
            self.assertEqual({tuple(row[7:22]) for row in rows}, {(0.0,) * 15})
            self.assertGreater(max(row[22] for row in rows) - min(row[22] for row in rows), 0.2)

    def test_usage(self):
        self.assert_fails(self.run_tool("live", "--robot", "unitree_g1", "--follow", "hands"), 2, "arms")


if __name__ == "__main__":
    unittest.main()
