"""Poses to BVH text: y up, centimetres, root position and ZYX Euler angles in degrees, `%.6f`, LF."""

import numpy as np

from body import BONE_AXES, JOINTS

Array = np.ndarray

# World (x forward, y left, z up) to file (y up): file = (x, z, -y).
TO_FILE = np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]])


def number(value: float) -> str:
    """`%.6f` without a negative zero, so that rounding noise cannot flip a sign in the file."""
    text = f"{value:.6f}"
    return "0.000000" if text == "-0.000000" else text


def _nearest_turn(angle: float, near: float) -> float:
    return angle + 360.0 * round((near - angle) / 360.0)


def euler_zyx(rotation: Array, before: Array | None) -> Array:
    """Angles z, y, x (degrees) with R = Rz Ry Rx, of the two solutions the one nearest to `before`."""
    y = np.degrees(np.arcsin(np.clip(-rotation[2, 0], -1.0, 1.0)))
    z = np.degrees(np.arctan2(rotation[1, 0], rotation[0, 0]))
    x = np.degrees(np.arctan2(rotation[2, 1], rotation[2, 2]))
    if before is None:
        return np.array([z, y, x])
    solutions = [np.array([_nearest_turn(a, b) for a, b in zip(s, before)])
                 for s in ((z, y, x), (z + 180.0, 180.0 - y, x + 180.0))]
    return min(solutions, key=lambda s: float(np.abs(s - before).sum()))


def _hierarchy() -> list[str]:
    lines = ["HIERARCHY"]

    def offset(values: tuple) -> str:
        return "OFFSET " + " ".join(number(100.0 * v) for v in values)

    def write(index: int, depth: int) -> None:
        joint, tab = JOINTS[index], "\t" * depth
        lines.append(f"{tab}{'JOINT' if depth else 'ROOT'} {joint.name}")
        lines.append(tab + "{")
        lines.append(f"{tab}\t{offset(joint.offset)}")
        position = "" if depth else "Xposition Yposition Zposition "
        lines.append(f"{tab}\tCHANNELS {3 if depth else 6} {position}Zrotation Yrotation Xrotation")
        for child, other in enumerate(JOINTS):
            if other.parent == index:
                write(child, depth + 1)
        if joint.end is not None:
            lines.extend([f"{tab}\tEnd Site", tab + "\t{", f"{tab}\t\t{offset(joint.end)}", tab + "\t}"])
        lines.append(tab + "}")

    write(0, 0)
    return lines


def bvh_text(poses: list[tuple[Array, list[Array]]], frame_time: float) -> str:
    """A BVH file from frames of (hips position in metres, world rotation of each bone's anatomical frame)."""
    lines = _hierarchy()
    lines += ["MOTION", f"Frames: {len(poses)}", f"Frame Time: {number(frame_time)}"]
    last: list[Array | None] = [None] * len(JOINTS)
    for position, anatomical in poses:
        world = [TO_FILE @ a @ axes for a, axes in zip(anatomical, BONE_AXES)]
        row = list(100.0 * (TO_FILE @ position))
        for i, joint in enumerate(JOINTS):
            local = world[i] if joint.parent < 0 else world[joint.parent].T @ world[i]
            angles = last[i] = euler_zyx(local, last[i])
            row.extend(angles)
        lines.append(" ".join(number(v) for v in row))
    return "\n".join(lines) + "\n"
