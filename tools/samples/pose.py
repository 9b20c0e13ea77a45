"""A whole-body pose in anatomical terms and its solution to world rotations of every bone.

World frame: x forward, y left, z up, metres; angles in radians. Sides: +1 is left, -1 is right.
"""

from dataclasses import dataclass, field

import numpy as np

from body import (BONE_AXES, FOREARM, INDEX, JOINTS, SHIN, SIDES, THIGH, UPPER_ARM, frame_from, rot_x, rot_y, rot_z,
                  unit)

Array = np.ndarray

# Resting clavicles point back and slightly down; exactly sideways would be the gimbal lock of the ZYX order.
CLAVICLE_BACK, CLAVICLE_DOWN = np.radians(10.0), np.radians(6.0)


class Unreachable(ValueError):
    """A planted foot is further away than the leg is long."""


@dataclass
class Arm:
    """Angles from the chest; `target` (wrist, world) takes over as `weight` goes to 1."""

    flexion: float = 0.0  # arm forward and up
    abduction: float = np.radians(10.0)  # arm away from the trunk
    rotation: float = 0.0  # positive turns the bent forearm inwards
    elbow: float = np.radians(12.0)
    pronation: float = np.radians(15.0)  # palm from facing the thigh to facing back
    wrist: float = 0.0  # towards the palm
    elevation: float = 0.0  # shoulder girdle, up
    protraction: float = 0.0  # shoulder girdle, forward
    target: Array | None = None
    pole: Array | None = None  # direction the elbow points in, world
    weight: float = 0.0
    hand: Array | None = None  # world rotation of the hand's anatomical frame, taken with `hand_weight`
    hand_weight: float = 0.0


@dataclass
class Leg:
    """World targets of one leg."""

    ankle: Array
    foot: Array  # world rotation of the foot's anatomical frame
    toe: float = 0.0  # toe extension, up
    pole: Array = field(default_factory=lambda: np.array([1.0, 0, 0]))  # direction the knee points in, world


@dataclass
class Pose:
    """Trunk and neck angles are (forward flexion, bend to the right, twist to the left), summed over the spine."""

    pelvis: Array  # position of the hips joint
    turn: Array  # world rotation of the pelvis
    legs: dict[str, Leg]
    arms: dict[str, Arm]
    trunk: Array = field(default_factory=lambda: np.zeros(3))
    neck: Array = field(default_factory=lambda: np.zeros(3))


def side_sign(side: str) -> float:
    return 1.0 if side == "Left" else -1.0


def joint_offset(name: str, parent_turn: Array) -> Array:
    """World vector from a joint's parent to the joint."""
    joint = JOINTS[INDEX[name]]
    return parent_turn @ BONE_AXES[joint.parent] @ np.array(joint.offset)


def middle_joint(root: Array, end: Array, upper: float, lower: float, pole: Array) -> Array:
    """Knee or elbow of a two-bone limb; raises Unreachable when `end` is too far."""
    line = end - root
    distance = np.sqrt(line @ line)
    if distance > upper + lower or distance < abs(upper - lower):
        raise Unreachable(f"distance {distance:.4f} m for bones of {upper:.3f} and {lower:.3f} m")
    along = (upper * upper - lower * lower + distance * distance) / (2.0 * distance)
    line = line / distance
    side = unit(pole - line * (pole @ line))
    return root + along * line + np.sqrt(max(upper * upper - along * along, 0.0)) * side


def within_reach(root: Array, end: Array, reach: float) -> Array:
    """`end` drawn smoothly towards `root` so that it stays within 99.5 % of `reach`."""
    line = end - root
    distance = np.sqrt(line @ line)
    knee, limit = 0.96 * reach, 0.995 * reach
    if distance <= knee:
        return end
    return root + line / distance * (knee + (limit - knee) * np.tanh((distance - knee) / (limit - knee)))


def rotation_between(a: Array, b: Array, weight: float) -> Array:
    """Rotation on the shortest way from a (weight 0) to b (weight 1)."""
    delta = a.T @ b
    angle = np.arccos(np.clip((np.trace(delta) - 1.0) / 2.0, -1.0, 1.0))
    if weight <= 0.0 or angle < 1e-9:
        return a
    axis = unit(np.array([delta[2, 1] - delta[1, 2], delta[0, 2] - delta[2, 0], delta[1, 0] - delta[0, 1]]))
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    part = weight * angle
    return a @ (np.eye(3) + np.sin(part) * k + (1.0 - np.cos(part)) * k @ k)


def flat_hand(side: str, heading: float) -> Array:
    """Hand on the floor, palm down, fingers towards `heading` (radians from world x)."""
    fingers = np.array([np.cos(heading), np.sin(heading), 0.0])
    up = np.array([0, 0, side_sign(side)])
    return np.column_stack([np.cross(up, -fingers), up, -fingers])


def _bend(angles: Array, part: float) -> Array:
    flexion, right, twist = part * np.asarray(angles)
    return rot_z(twist) @ rot_x(right) @ rot_y(flexion)


def hip_joint(pelvis: Array, turn: Array, side: str) -> Array:
    """World position of a hip joint."""
    return pelvis + joint_offset(side + "UpLeg", turn)


def solve(pose: Pose) -> tuple[Array, list[Array]]:
    """Hips position and world rotation of every bone's anatomical frame, in joint order."""
    turns: dict[str, Array] = {"Hips": pose.turn}
    for side in SIDES:
        _solve_leg(pose, side, turns)
    turns["Spine"] = pose.turn @ _bend(pose.trunk, 0.30)
    turns["Spine1"] = turns["Spine"] @ _bend(pose.trunk, 0.35)
    turns["Spine2"] = turns["Spine1"] @ _bend(pose.trunk, 0.35)
    turns["Neck"] = turns["Spine2"] @ _bend(pose.neck, 0.45)
    turns["Head"] = turns["Neck"] @ _bend(pose.neck, 0.55)
    chest = pose.pelvis
    for name, parent in (("Spine", "Hips"), ("Spine1", "Spine"), ("Spine2", "Spine1")):
        chest = chest + joint_offset(name, turns[parent])
    for side in SIDES:
        _solve_arm(pose.arms[side], side, chest, turns)
    return pose.pelvis, [turns[joint.name] for joint in JOINTS]


def _solve_leg(pose: Pose, side: str, turns: dict[str, Array]) -> None:
    leg = pose.legs[side]
    hip = hip_joint(pose.pelvis, pose.turn, side)
    knee = middle_joint(hip, leg.ankle, THIGH, SHIN, leg.pole)
    # Both bones share the hinge axis, which the pole defines even when the leg is straight.
    hinge = unit(np.cross(leg.pole, leg.ankle - hip))
    for name, bone in ((side + "UpLeg", hip - knee), (side + "Leg", knee - leg.ankle)):
        up = unit(bone)
        turns[name] = np.column_stack([np.cross(hinge, up), hinge, up])
    turns[side + "Foot"] = leg.foot
    turns[side + "Toe"] = leg.foot @ rot_y(-leg.toe)


def _solve_arm(arm: Arm, side: str, chest: Array, turns: dict[str, Array]) -> None:
    sign = side_sign(side)
    torso = turns["Spine2"]
    clavicle = torso @ rot_z(sign * (CLAVICLE_BACK - arm.protraction)) @ rot_x(sign * (arm.elevation - CLAVICLE_DOWN))
    upper = torso @ rot_y(-arm.flexion) @ rot_x(sign * arm.abduction) @ rot_z(-sign * arm.rotation)
    lower = upper @ rot_y(-arm.elbow)
    shoulder = chest + joint_offset(side + "Shoulder", torso)
    shoulder = shoulder + joint_offset(side + "Arm", clavicle)
    if arm.weight > 0.0 and arm.target is not None and arm.pole is not None:
        elbow = shoulder - UPPER_ARM * upper[:, 2]
        wrist = elbow - FOREARM * lower[:, 2]
        away = unit(unit(elbow - 0.5 * (shoulder + wrist)) * (1.0 - arm.weight) + unit(arm.pole) * arm.weight)
        goal = within_reach(shoulder, wrist + arm.weight * (arm.target - wrist), UPPER_ARM + FOREARM)
        elbow = middle_joint(shoulder, goal, UPPER_ARM, FOREARM, away)
        hinge = unit(np.cross(goal - shoulder, away))
        upper = frame_from(np.cross(hinge, shoulder - elbow), shoulder - elbow)
        lower = frame_from(np.cross(hinge, elbow - goal), elbow - goal)
    hand = lower @ rot_z(-sign * arm.pronation) @ rot_x(-sign * arm.wrist)
    if arm.hand is not None:
        hand = rotation_between(hand, arm.hand, arm.hand_weight)
    turns[side + "Shoulder"], turns[side + "Arm"], turns[side + "ForeArm"] = clavicle, upper, lower
    turns[side + "Hand"] = hand


def positions(solution: tuple[Array, list[Array]]) -> dict[str, Array]:
    """World positions of the joints and, as NAME.end, of the end sites."""
    hips, turns = solution
    out = [hips]
    places = {"Hips": hips}
    for i, joint in enumerate(JOINTS):
        if i:
            out.append(out[joint.parent] + turns[joint.parent] @ BONE_AXES[joint.parent] @ np.array(joint.offset))
            places[joint.name] = out[i]
        if joint.end is not None:
            places[joint.name + ".end"] = out[i] + turns[i] @ BONE_AXES[i] @ np.array(joint.end)
    return places
