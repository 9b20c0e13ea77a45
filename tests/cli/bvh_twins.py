"""BVH files as joints and rows, for tests that alter them: dropped joints, other channels, frames in front."""

import numpy

AXES = "XYZ"


class Joint:
    def __init__(self, name, parent, offset, channels, ends):
        self.name, self.parent, self.offset = name, parent, offset
        self.channels, self.ends = channels, ends


class Bvh:
    """A clip in the format of the samples: one token stream, one row per line."""

    def __init__(self, path):
        lines = path.read_text().splitlines()
        motion = lines.index("MOTION")
        self.joints, self.frame_time = [], lines[motion + 2].split()[2]
        self._read_hierarchy(" ".join(lines[:motion]).split())
        rows = numpy.array([[float(x) for x in line.split()] for line in lines[motion + 3:] if line])
        self.values, column = [], 0
        for joint in self.joints:
            self.values.append(rows[:, column:column + len(joint.channels)])
            column += len(joint.channels)

    def _read_hierarchy(self, tokens):
        open_joints, at = [], 0
        while at < len(tokens):
            word = tokens[at]
            if word in ("ROOT", "JOINT"):
                parent = open_joints[-1] if open_joints else -1
                self.joints.append(Joint(tokens[at + 1], parent, None, [], []))
                open_joints.append(len(self.joints) - 1)
                at += 3
            elif word == "End":
                self.joints[open_joints[-1]].ends.append(numpy.array(tokens[at + 4:at + 7], float))
                at += 8
            elif word == "OFFSET":
                self.joints[-1].offset = numpy.array(tokens[at + 1:at + 4], float)
                at += 4
            elif word == "CHANNELS":
                count = int(tokens[at + 1])
                self.joints[-1].channels = tokens[at + 2:at + 2 + count]
                at += 2 + count
            elif word == "}":
                open_joints.pop()
                at += 1
            else:
                at += 1

    def index(self, name):
        return next(i for i, joint in enumerate(self.joints) if joint.name == name)

    @property
    def frames(self):
        return len(self.values[0])

    def drop(self, *names):
        """Removes joints and their descendants."""
        gone = set()
        for i, joint in enumerate(self.joints):
            if joint.name in names or joint.parent in gone:
                gone.add(i)
        new = {-1: -1}
        for i in range(len(self.joints)):
            if i not in gone:
                new[i] = len(new) - 1
        self.values = [v for i, v in enumerate(self.values) if i not in gone]
        self.joints = [joint for i, joint in enumerate(self.joints) if i not in gone]
        for joint in self.joints:
            joint.parent = new[joint.parent]

    def in_front(self, rows):
        """Prepends frames: one list of values per joint."""
        self.values = [numpy.vstack([[row[i]] for row in rows] + [v])
                       for i, v in enumerate(self.values)]

    def zero_row(self):
        """All rotations zero, positions as in the first frame."""
        return [numpy.array([0.0 if c.endswith("rotation") else x
                             for c, x in zip(joint.channels, v[0])])
                for joint, v in zip(self.joints, self.values)]

    def world(self):
        """Positions (frames, joints, 3) and rotations (frames, joints, 3, 3) of all joints."""
        positions = numpy.zeros((self.frames, len(self.joints), 3))
        rotations = numpy.zeros((self.frames, len(self.joints), 3, 3))
        for i, (joint, values) in enumerate(zip(self.joints, self.values)):
            local = numpy.tile(joint.offset, (self.frames, 1))
            turn = numpy.tile(numpy.eye(3), (self.frames, 1, 1))
            for channel, column in zip(joint.channels, values.T):
                axis = AXES.index(channel[0].upper())
                if channel.endswith("position"):
                    local[:, axis] = column
                else:
                    turn = turn @ about(axis, column)
            if joint.parent < 0:
                positions[:, i], rotations[:, i] = local, turn
                continue
            above = rotations[:, joint.parent]
            positions[:, i] = positions[:, joint.parent] + numpy.einsum("fab,fb->fa", above, local)
            rotations[:, i] = above @ turn
        return positions, rotations

    def text(self):
        lines, open_joints = ["HIERARCHY"], []
        for i, joint in enumerate(self.joints):
            while open_joints and open_joints[-1] != joint.parent:
                open_joints.pop()
                lines.append("}")
            lines += [("JOINT " if open_joints else "ROOT ") + joint.name, "{",
                      "OFFSET " + " ".join(f"{x:.6f}" for x in joint.offset),
                      f"CHANNELS {len(joint.channels)} " + " ".join(joint.channels)]
            for end in joint.ends:
                lines += ["End Site", "{", "OFFSET " + " ".join(f"{x:.6f}" for x in end), "}"]
            open_joints.append(i)
        lines += ["}"] * len(open_joints)
        lines += ["MOTION", f"Frames: {self.frames}", f"Frame Time: {self.frame_time}"]
        lines += [" ".join(f"{x:.7f}" for x in row) for row in numpy.hstack(self.values)]
        return "\n".join(lines) + "\n"


def about(axis, degrees):
    """Rotations (frames, 3, 3) about an axis of the coordinate system."""
    sine, cosine = numpy.sin(numpy.radians(degrees)), numpy.cos(numpy.radians(degrees))
    matrix = numpy.zeros((len(degrees), 3, 3))
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrix[:, axis, axis] = 1.0
    matrix[:, a, a] = matrix[:, b, b] = cosine
    matrix[:, a, b], matrix[:, b, a] = -sine, sine
    return matrix
