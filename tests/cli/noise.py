"""Noise of video estimates and IMU suits, added to BVH files, for tests of --clean.

Files have one tree whose root alone has position channels, in centimetres, Y up, as those of data/ have.
"""

import math
import pathlib
import random
import struct


class Motion:
    """A BVH file's joints, frame time and rows."""

    def __init__(self, path):
        text = pathlib.Path(path).read_text()
        self.hierarchy, motion = text.split("MOTION\n")
        lines = motion.splitlines()
        self.frame_time = float(lines[1].split(":")[1])
        self.rows = [[float(value) for value in line.split()] for line in lines[2:] if line.strip()]
        self.joints = []  # name, parent, offset, axes of the rotation channels, first rotation column
        self._read_hierarchy()

    def _read_hierarchy(self):
        stack, column, in_end_site = [], 0, False
        for words in map(str.split, self.hierarchy.splitlines()):
            if not words:
                continue
            if words[0] in ("ROOT", "JOINT"):
                self.joints.append({"name": words[1], "parent": stack[-1] if stack else -1})
            elif words[0] == "End":
                in_end_site = True
            elif words[0] == "{":
                stack.append(len(self.joints) - 1)
            elif words[0] == "}":
                stack.pop()
                in_end_site = False
            elif words[0] == "OFFSET" and not in_end_site:
                self.joints[-1]["offset"] = [float(value) for value in words[1:]]
            elif words[0] == "CHANNELS":
                axes = [word[0] for word in words[2:]]
                self.joints[-1]["column"] = column + len(axes) - 3
                self.joints[-1]["axes"] = axes[-3:]
                column += len(axes)

    def text(self):
        head = f"MOTION\nFrames: {len(self.rows)}\nFrame Time: {self.frame_time:.6f}\n"
        rows = "\n".join(" ".join(f"{value:.6f}" for value in row) for row in self.rows)
        return self.hierarchy + head + rows + "\n"

    def positions(self):
        """World positions in centimetres by frame and joint."""
        frames = []
        for row in self.rows:
            turns, places = [], []
            for joint in self.joints:
                turn, place = rotation_of(row, joint), joint["offset"]
                if joint["parent"] < 0:
                    place = row[:3]
                else:
                    above = turns[joint["parent"]]
                    base = places[joint["parent"]]
                    place = [base[i] + sum(above[i][k] * place[k] for k in range(3))
                             for i in range(3)]
                    turn = product(above, turn)
                turns.append(turn)
                places.append(place)
            frames.append(places)
        return frames


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def about(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    return {"X": [[1, 0, 0], [0, c, -s], [0, s, c]],
            "Y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
            "Z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[axis]


def rotation_of(row, joint):
    turn = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    for i, axis in enumerate(joint["axes"]):
        turn = product(turn, about(axis, math.radians(row[joint["column"] + i])))
    return turn


def zyx_degrees(m):
    """Angles of Z, Y, X, in that order, of a rotation."""
    y = math.asin(max(-1.0, min(1.0, -m[2][0])))
    return [math.degrees(math.atan2(m[1][0], m[0][0])), math.degrees(y),
            math.degrees(math.atan2(m[2][1], m[2][2]))]


def rotation_vector(v):
    angle = math.sqrt(sum(x * x for x in v))
    if angle < 1e-12:
        return [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    x, y, z = (value / angle for value in v)
    c, s = math.cos(angle), math.sin(angle)
    d = 1 - c
    return [[c + x * x * d, x * y * d - z * s, x * z * d + y * s],
            [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
            [z * x * d - y * s, z * y * d + x * s, c + z * z * d]]


def ar1(rng, frames, sigma, seconds, frame_time):
    """Noise with a standard deviation and a correlation time in seconds."""
    keep = math.exp(-frame_time / seconds)
    fresh = sigma * math.sqrt(1.0 - keep * keep)
    value, values = rng.gauss(0.0, sigma), []
    for _ in range(frames):
        values.append(value)
        value = keep * value + rng.gauss(0.0, fresh)
    return values


def rotation_noise(motion, degrees, seed=1, seconds=0.3):
    """AR(1) noise on all joint rotations, with this RMS angle in degrees."""
    rng, frames = random.Random(seed), len(motion.rows)
    sigma = math.radians(degrees) / math.sqrt(3.0)
    for joint in motion.joints:
        assert joint["axes"] == ["Z", "Y", "X"], joint
        noise = [ar1(rng, frames, sigma, seconds, motion.frame_time) for _ in range(3)]
        for row, turn in zip(motion.rows, zip(*noise)):
            column = joint["column"]
            row[column:column + 3] = zyx_degrees(
                product(rotation_of(row, joint), rotation_vector(turn)))


def root_noise(motion, depth=0.0, vertical=0.0, seed=1, seconds=0.5):
    """AR(1) noise of the root along z (from the camera) and y (up), metres."""
    rng, frames = random.Random(seed), len(motion.rows)
    along_z = ar1(rng, frames, 100.0 * depth, seconds, motion.frame_time)
    along_y = ar1(rng, frames, 100.0 * vertical, seconds, motion.frame_time)
    for row, y, z in zip(motion.rows, along_y, along_z):
        row[1] += y
        row[2] += z


def sway(motion, metres, seconds=4.0):
    """The root swings along x."""
    for frame, row in enumerate(motion.rows):
        row[0] += 100.0 * metres * math.sin(2.0 * math.pi * frame * motion.frame_time / seconds)


def floor_drift(motion, metres):
    """The body climbs steadily."""
    for frame, row in enumerate(motion.rows):
        row[1] += 100.0 * metres * frame / (len(motion.rows) - 1)


def foot_sliding(motion, factor):
    """The root moves farther than the feet."""
    start = list(motion.rows[0])
    for row in motion.rows:
        for axis in (0, 2):
            row[axis] = start[axis] + factor * (row[axis] - start[axis])


def frozen_frames(motion, count=4, frames=6, seed=1):
    """The motion freezes and then jumps."""
    rng = random.Random(seed)
    for _ in range(count):
        first = rng.randrange(10, len(motion.rows) - frames - 10)
        for frame in range(first + 1, first + frames):
            motion.rows[frame] = list(motion.rows[first])


def lost_joint(motion, name, share=0.03, seed=1):
    """The rotation of a joint is repeatedly zero for a few frames."""
    rng = random.Random(seed)
    column = next(joint["column"] for joint in motion.joints if joint["name"] == name)
    for row in motion.rows[2:-2]:
        if rng.random() < share:
            row[column:column + 3] = [0.0, 0.0, 0.0]


def keypoints(motion, white=0.0, slow=0.0, dropouts=0.0, lost=0.0, seed=1):
    """World positions in metres by frame and joint, with noise in metres; dropouts are at `lost`."""
    rng, frames = random.Random(seed), motion.positions()
    for joint in range(len(motion.joints)):
        tracks = [ar1(rng, len(frames), slow, 0.3, motion.frame_time) for _ in range(3)]
        for frame, places in enumerate(frames):
            places[joint] = [0.01 * places[joint][axis] + tracks[axis][frame]
                             + rng.gauss(0.0, white) for axis in range(3)]
            if joint > 0 and 1 < frame < len(frames) - 2 and rng.random() < dropouts:
                places[joint] = [lost] * 3
    return frames


def npy(frames):
    """Positions as the bytes of an NPY file of doubles."""
    shape = (len(frames), len(frames[0]), 3)
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"
    head += " " * (-(len(head) + 11) % 64) + "\n"
    values = [value for places in frames for place in places for value in place]
    return (b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode()
            + struct.pack(f"<{len(values)}d", *values))
