"""The sample human: an adult of 1.75 m with LAFAN1's joint names, order and bone axes and its own proportions.

World frame: x forward, y left, z up, metres. Every bone has an anatomical frame (x forward, y left, z up
when standing with hanging arms and flat feet) that poses are written in, and the bone axes of the file
(limb along local +X), a constant rotation away.
"""

from dataclasses import dataclass

import numpy as np

Array = np.ndarray

SIDES = ("Left", "Right")

# Lengths in metres. The leg sums to 0.844 above an ankle 0.086 high: hips at 53 % of the height.
THIGH, SHIN = 0.426, 0.418
ANKLE_HEIGHT, TOE_HEIGHT = 0.086, 0.018
FOOT = 0.164  # ankle to ball
TOE = 0.062  # ball to toe tip
UPPER_ARM, FOREARM, HAND = 0.312, 0.258, 0.174
CLAVICLE = 0.122
HIP_SIDE = 0.096

# The foot bone runs from the ankle down to the ball; its anatomical frame is level when the sole is.
FOOT_DROP = float(np.arcsin((ANKLE_HEIGHT - TOE_HEIGHT) / FOOT))
BALL = np.array([FOOT * np.cos(FOOT_DROP), 0.0, TOE_HEIGHT - ANKLE_HEIGHT])  # from the ankle, level foot
HEEL = np.array([-0.050, 0.0, -ANKLE_HEIGHT])  # sole point under the heel, from the ankle


@dataclass(frozen=True)
class Joint:
    """A joint as the file has it: offset from the parent in the parent's bone axes (metres)."""

    name: str
    parent: int
    offset: tuple[float, float, float]
    end: tuple[float, float, float] | None = None  # end site


def _leg(side: str, base: int) -> list[Joint]:
    sign = 1.0 if side == "Left" else -1.0
    return [Joint(side + "UpLeg", 0, (-0.004, 0.012, sign * HIP_SIDE)), Joint(side + "Leg", base, (THIGH, 0, 0)),
            Joint(side + "Foot", base + 1, (SHIN, 0, 0)), Joint(side + "Toe", base + 2, (FOOT, 0, 0), (TOE, 0, 0))]


def _arm(side: str, base: int) -> list[Joint]:
    sign = 1.0 if side == "Left" else -1.0
    return [Joint(side + "Shoulder", 11, (0.196, -0.010, sign * 0.054)), Joint(side + "Arm", base, (CLAVICLE, 0, 0)),
            Joint(side + "ForeArm", base + 1, (UPPER_ARM, 0, 0)),
            Joint(side + "Hand", base + 2, (FOREARM, 0, 0), (HAND, 0, 0))]


JOINTS: list[Joint] = [
    Joint("Hips", -1, (0.0, 0.0, 0.0)), *_leg("Left", 1), *_leg("Right", 5),
    Joint("Spine", 0, (0.074, -0.022, 0)), Joint("Spine1", 9, (0.118, 0, 0)), Joint("Spine2", 10, (0.126, 0, 0)),
    Joint("Neck", 11, (0.252, 0, 0)), Joint("Head", 12, (0.112, 0, 0), (0.142, 0, 0)),
    *_arm("Left", 14), *_arm("Right", 18),
]
INDEX = {joint.name: i for i, joint in enumerate(JOINTS)}


def rot_x(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0, 0], [0, c, -s], [0, s, c]])


def rot_y(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1.0, 0], [-s, 0, c]])


def rot_z(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def unit(v: Array) -> Array:
    return v / np.sqrt(v @ v)


def frame_from(x_axis: Array, z_axis: Array) -> Array:
    """Rotation whose z is `z_axis` and whose x is as near to `x_axis` as it can be."""
    z = unit(z_axis)
    y = unit(np.cross(z, x_axis))
    return np.column_stack([np.cross(y, z), y, z])


def _axes(x: str, y: str, z: str) -> Array:
    """Constant rotation from named directions of the anatomical frame."""
    named = {"forward": (1, 0, 0), "back": (-1, 0, 0), "left": (0, 1, 0), "right": (0, -1, 0),
             "up": (0, 0, 1), "down": (0, 0, -1)}
    return np.array([named[x], named[y], named[z]], float).T


def _bone_axes(name: str) -> Array:
    """Bone axes in the anatomical frame of the bone."""
    if name.endswith("Foot"):
        return _axes("forward", "up", "right") @ rot_z(-FOOT_DROP)
    if name.endswith("Toe"):
        return _axes("forward", "up", "right")
    if name.endswith(("UpLeg", "Leg")):
        return _axes("down", "forward", "right")
    if name.endswith("Shoulder"):
        return _axes("left", "back", "up") if name.startswith("Left") else _axes("right", "back", "down")
    if name.endswith(("Arm", "Hand")):
        return _axes("down", "back", "left")  # the T-pose's axes after lowering the arm, the same for both sides
    return _axes("up", "forward", "left")


BONE_AXES: list[Array] = [_bone_axes(joint.name) for joint in JOINTS]

# Capsule radius (metres) along each bone, for floor contact.
RADII = {"Hips": 0.095, "Spine": 0.085, "Spine1": 0.085, "Spine2": 0.085, "Neck": 0.05, "Head": 0.085,
         "Shoulder": 0.05, "UpLeg": 0.065, "Leg": 0.045, "Foot": 0.018, "Toe": 0.018,
         "Arm": 0.042, "ForeArm": 0.035, "Hand": 0.022}


def radius(name: str) -> float:
    """Capsule radius of a bone, metres."""
    return RADII[name.removeprefix("Left").removeprefix("Right")]
