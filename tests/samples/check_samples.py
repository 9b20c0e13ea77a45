#!/usr/bin/env python3
"""Checks the documented properties of the committed samples, using only the BVH files.

    check_samples.py data/

Reads the files with its own parser and forward kinematics (world: x forward, y left, z up, metres) and
shares nothing with the generator. Prints one line a clip; on failure says which promise was broken, and exits 1.
"""

import pathlib
import sys

import numpy as np

Array = np.ndarray

FPS = 30.0
TOE_RADIUS = 0.018  # toe joint and toe tip above the floor when the foot is flat, metres
HEEL = np.array([-0.050, -0.086, 0.0])  # heel sole point from the ankle: along the level foot, up (in foot axes, level)
DURATIONS = {"walk": 10.0, "turn_in_place": 6.0, "squat": 5.0, "wave": 4.0, "get_up": 9.5}
NAMES = ["Hips", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToe", "RightUpLeg", "RightLeg", "RightFoot", "RightToe",
         "Spine", "Spine1", "Spine2", "Neck", "Head", "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand",
         "RightShoulder", "RightArm", "RightForeArm", "RightHand"]
# Capsule radii along the bones, metres, for depth below the floor.
RADII = {"Hips": 0.095, "Spine": 0.085, "Spine1": 0.085, "Spine2": 0.085, "Neck": 0.05, "Head": 0.085, "Shoulder": 0.05,
         "UpLeg": 0.065, "Leg": 0.045, "Foot": 0.018, "Toe": 0.018, "Arm": 0.042, "ForeArm": 0.035, "Hand": 0.022}


class Broken(Exception):
    """A violated property of a clip."""


def expect(condition: bool, message: str) -> None:
    if not condition:
        raise Broken(message)


class Clip:
    """A BVH file: joint positions (frames, 3), rotations (frames, 3, 3) and end sites by name."""

    def __init__(self, path: pathlib.Path) -> None:
        raw = path.read_bytes()
        expect(b"\r" not in raw, "line ends are not LF")
        head, motion = raw.decode("ascii").split("MOTION\n")
        self.names: list[str] = []
        self.parents: list[int] = []
        self.offsets: list[Array] = []
        self.ends: dict[str, Array] = {}
        stack: list[int] = []
        end_site = False
        for words in (line.split() for line in head.splitlines()):
            if words[0] in ("ROOT", "JOINT"):
                self.names.append(words[1])
                self.parents.append(stack[-1] if stack else -1)
                stack.append(len(self.names) - 1)
            elif words[0] == "End":
                end_site = True
                stack.append(-2)
            elif words[0] == "}":
                stack.pop()
                end_site = False
            elif words[0] == "OFFSET":
                value = np.array(words[1:], float) / 100.0
                if end_site:
                    self.ends[self.names[-1]] = value
                else:
                    self.offsets.append(value)
            elif words[0] == "CHANNELS":
                rotations = ["Zrotation", "Yrotation", "Xrotation"]
                wanted = ["Xposition", "Yposition", "Zposition"] + rotations if len(self.names) == 1 else rotations
                expect(words[1:] == [str(len(wanted))] + wanted, f"channels of {self.names[-1]}: {words}")
        lines = motion.splitlines()
        self.frame_time = float(lines[1].split(":")[1])
        self.rows = np.array([line.split() for line in lines[2:]], float)
        expect(int(lines[0].split(":")[1]) == len(self.rows), "the frame count is not the number of rows")
        self._pose()

    def _pose(self) -> None:
        """Forward kinematics in file axes, then to z up: (x, -z, y)."""
        z_up = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
        frames = len(self.rows)
        places: list[Array] = []
        turns: list[Array] = []
        self.local: list[Array] = []
        for j, parent in enumerate(self.parents):
            z, y, x = np.radians(self.rows[:, 3 + 3 * j : 6 + 3 * j].T)
            zero, one = np.zeros(frames), np.ones(frames)
            rz = np.array([[np.cos(z), -np.sin(z), zero], [np.sin(z), np.cos(z), zero], [zero, zero, one]]).transpose(2, 0, 1)
            ry = np.array([[np.cos(y), zero, np.sin(y)], [zero, one, zero], [-np.sin(y), zero, np.cos(y)]]).transpose(2, 0, 1)
            rx = np.array([[one, zero, zero], [zero, np.cos(x), -np.sin(x)], [zero, np.sin(x), np.cos(x)]]).transpose(2, 0, 1)
            self.local.append(rz @ ry @ rx)
            if parent < 0:
                places.append(self.rows[:, :3] / 100.0)
                turns.append(self.local[j])
            else:
                places.append(places[parent] + turns[parent] @ self.offsets[j])
                turns.append(turns[parent] @ self.local[j])
        self.at = {n: p @ z_up.T for n, p in zip(self.names, places)}
        self.turn = {n: z_up @ r for n, r in zip(self.names, turns)}
        self.end = {n: self.at[n] + self.turn[n] @ e for n, e in self.ends.items()}

    def heel(self, side: str) -> Array:
        """Sole point under the heel. Foot axes: x down along the foot, y up, z right."""
        foot = self.turn[side + "Foot"]
        drop = np.arcsin((0.086 - 0.018) / np.linalg.norm(self.offsets[self.names.index(side + "Toe")]))
        level = np.array([HEEL[0] * np.cos(drop) - HEEL[1] * np.sin(drop), HEEL[0] * np.sin(drop) + HEEL[1] * np.cos(drop), 0.0])
        return self.at[side + "Foot"] + foot @ level

    def sole(self, side: str) -> dict[str, Array]:
        """Heel, ball and toe tip at the height of the sole."""
        drop = np.array([0, 0, TOE_RADIUS])
        return {"heel": self.heel(side), "ball": self.at[side + "Toe"] - drop, "tip": self.end[side + "Toe"] - drop}

    def yaw(self) -> Array:
        """Heading of the pelvis: its forward is the bone's local y."""
        forward = self.turn["Hips"][:, :, 1]
        return np.unwrap(np.arctan2(forward[:, 1], forward[:, 0]))


def check_form(clip: Clip, name: str) -> None:
    expect(clip.names == NAMES, "joint names or their order")
    expect(abs(clip.frame_time - 0.033333) < 1e-9, f"frame time {clip.frame_time}")
    expect(len(clip.rows) == int(DURATIONS[name] * FPS) + 1, f"{len(clip.rows)} frames for {DURATIONS[name]} s")
    for j in range(len(NAMES)):
        if clip.parents[j] > 0 and NAMES[clip.parents[j]] not in ("Spine2",):
            length = np.linalg.norm(clip.at[NAMES[j]] - clip.at[NAMES[clip.parents[j]]], axis=1)
            expect(float(np.ptp(length)) < 1e-5, f"{NAMES[j]}: bone length changes")
            expect(bool(np.all(clip.offsets[j][1:] == 0.0)) and clip.offsets[j][0] > 0.0, f"{NAMES[j]}: not along local +X")
    for side in ("Left", "Right"):
        expect(0.75 < sum(clip.offsets[NAMES.index(side + b)][0] for b in ("Leg", "Foot")) < 0.95, "leg length")


def check_smooth(clip: Clip) -> float:
    worst = 0.0
    for name, local in zip(clip.names, clip.local):
        trace = np.einsum("fij,fij->f", local[1:], local[:-1])
        step = np.arccos(np.clip((trace - 1.0) / 2.0, -1.0, 1.0))
        expect(float(step.max()) < 0.35, f"{name}: step of {step.max():.2f} rad at frame {int(step.argmax()) + 1}")
        worst = max(worst, float(step.max()))
    jump = np.abs(np.diff(clip.rows[:, 3:], axis=0)).max(axis=0)
    j = int(jump.argmax())
    expect(float(jump[j]) < 180.0, f"{clip.names[j // 3]}: Euler angle jumps by {jump[j]:.0f} degrees")
    return worst


def check_sides(clip: Clip) -> None:
    """Left is left of where the pelvis and the feet point; knees and elbows bend the human way."""
    for name in ("UpLeg", "Arm"):
        across = clip.at["Left" + name] - clip.at["Right" + name]
        base = clip.turn["Hips" if name == "UpLeg" else "Spine2"]
        left = np.cross(base[:, :, 0], base[:, :, 1])  # up x forward
        expect(float(np.einsum("fi,fi->f", across, left).min()) > 0.1, f"{name}: left and right are swapped")
    for side in ("Left", "Right"):
        thigh = clip.at[side + "Leg"] - clip.at[side + "UpLeg"]
        shin = clip.at[side + "Foot"] - clip.at[side + "Leg"]
        hinge = clip.turn[side + "Leg"][:, :, 2]  # right
        expect(float(np.einsum("fi,fi->f", np.cross(thigh, shin), hinge).max()) < 1e-6, f"{side} knee bends forward")
        upper = clip.at[side + "ForeArm"] - clip.at[side + "Arm"]
        lower = clip.at[side + "Hand"] - clip.at[side + "ForeArm"]
        hinge = clip.turn[side + "ForeArm"][:, :, 2]
        expect(float(np.einsum("fi,fi->f", np.cross(upper, lower), hinge).max()) < 1e-6, f"{side} elbow bends backward")


def check_floor(clip: Clip, allowed: float) -> float:
    """No part of the body is deeper below the floor than `allowed` metres."""
    lowest = np.inf
    for j, name in enumerate(clip.names):
        reach = RADII[name.removeprefix("Left").removeprefix("Right")]
        children = [n for c, n in enumerate(NAMES) if clip.parents[c] == j and not n.endswith(("UpLeg", "Shoulder"))]
        points = [clip.at[name]] + [clip.at[c] for c in children] + ([clip.end[name]] if name in clip.end else [])
        height = np.min([p[:, 2] for p in points], axis=0) - reach
        expect(float(height.min()) > -allowed,
               f"{name}: {-1000 * height.min():.0f} mm below the floor at frame {int(height.argmin())}")
        lowest = min(lowest, float(height.min()))
    return lowest


def check_soles(clip: Clip) -> None:
    for side in ("Left", "Right"):
        for part, point in clip.sole(side).items():
            low = point[:, 2]
            expect(float(low.min()) > -0.002,
                   f"{side} {part}: {-1000 * low.min():.1f} mm below the floor at frame {int(low.argmin())}")


def contact_runs(clip: Clip, side: str) -> list[dict]:
    """Stances of a foot: first to last frame with a sole point within 0.3 mm of the floor, and what happened in them.

    While a point is down it moves less than 1 mm per frame; in the first and last frame of a contact the point may
    still be above the floor by less than those 0.3 mm and move by a few millimetres.
    """
    sole = clip.sole(side)
    down = {part: p[:, 2] < 0.0003 for part, p in sole.items()}
    for part in ("heel", "ball"):
        held = down[part]
        both = held[1:] & held[:-1]
        inner = both & np.append(both[1:], True) & np.append(True, both[:-1])
        moved = np.linalg.norm(np.diff(sole[part][:, :2], axis=0), axis=1)
        for mask, limit in ((inner, 0.001), (both, 0.005)):
            worst = int(np.argmax(np.where(mask, moved, 0.0)))
            expect(not mask[worst] or moved[worst] < limit,
                   f"{side} {part} slips {1000 * moved[worst]:.2f} mm at frame {worst + 1}")
    any_down = down["heel"] | down["ball"]
    edges = np.flatnonzero(np.diff(np.concatenate([[0], any_down.astype(int), [0]])))
    return [{"first": int(a), "end": int(b), **{p: np.flatnonzero(down[p][a:b]) + a for p in ("heel", "ball")}}
            for a, b in zip(edges[::2], edges[1::2])]


def check_planted(clip: Clip, name: str) -> None:
    """Both feet flat on the floor in all frames, without slip."""
    for side in ("Left", "Right"):
        for part, point in clip.sole(side).items():
            expect(float(np.abs(point[:, 2]).max()) < 0.001, f"{name}: {side} {part} leaves the floor")
            expect(float(np.linalg.norm(point[:, :2] - point[0, :2], axis=1).max()) < 0.001, f"{name}: {side} {part} slips")


def check_walk(clip: Clip) -> str:
    check_soles(clip)
    hips = clip.at["Hips"]
    distance = float(np.linalg.norm(hips[-1, :2] - hips[0, :2]))
    mid = hips[120:211]
    speed = float(np.linalg.norm(mid[-1, :2] - mid[0, :2])) / (90 / FPS)
    expect(7.0 < distance < 9.0, f"distance {distance:.2f} m")
    expect(1.1 < speed < 1.3, f"speed {speed:.2f} m/s")
    for ends in (hips[:10], hips[-10:]):
        expect(float(np.linalg.norm(ends[-1] - ends[0])) < 0.005, "does not start and end standing still")
    bob = float(np.ptp(mid[:, 2]))
    expect(0.025 < bob < 0.06, f"pelvis bob {bob:.3f} m")
    stance_time = 0
    runs = {side: contact_runs(clip, side) for side in ("Left", "Right")}
    for side, stances in runs.items():
        expect(len(stances) == 8, f"{side}: {len(stances)} stances")
        for k, s in enumerate(stances):
            if k > 0:
                expect(s["heel"][0] < s["ball"][0], f"{side} stance {k}: the toes land before the heel")
            if k + 1 < len(stances):
                expect(s["heel"][-1] < s["ball"][-1], f"{side} stance {k}: toe-off is not after heel-off")
                toe = clip.local[NAMES.index(side + "Toe")]
                level = toe[s["first"] + 4]
                bend = np.degrees(np.arccos(np.clip((np.trace(level.T @ toe[s["end"] - 1]) - 1.0) / 2.0, -1, 1)))
                expect(bend > 15.0, f"{side} stance {k}: the toes bend by {bend:.0f} degrees only at push-off")
            stance_time += sum(120 <= f < 210 for f in range(s["first"], s["end"]))
    duty = stance_time / 180.0
    expect(0.56 < duty < 0.68, f"stance is {100 * duty:.0f} % of the cycle")
    grounded = [np.zeros(len(clip.rows), bool) for _ in range(2)]
    for ground, side in zip(grounded, runs):
        for s in runs[side]:
            ground[s["first"] : s["end"]] = True
    expect(bool(np.all(grounded[0] | grounded[1])), "both feet are off the floor")
    double = float(np.mean((grounded[0] & grounded[1])[120:210]))
    expect(0.1 < double < 0.35, f"double support {100 * double:.0f} %")
    for side, other in (("Left", "Right"), ("Right", "Left")):
        hand = (clip.at[side + "Hand"] - clip.at[side + "Arm"])[120:211, 0]
        same = (clip.at[side + "Foot"] - hips)[120:211, 0]
        across = (clip.at[other + "Foot"] - hips)[120:211, 0]
        expect(float(np.corrcoef(hand, across)[0, 1]) > 0.7 > float(np.corrcoef(hand, same)[0, 1]),
               f"{side} arm swings with its own leg")
        expect(float(np.ptp(hand)) > 0.25, f"{side} arm hardly swings")
    twist = np.degrees(clip.yaw()[120:211])
    chest = clip.turn["Spine2"][120:211, :, 1]
    expect(float(np.corrcoef(twist, np.arctan2(chest[:, 1], chest[:, 0]))[0, 1]) < -0.5,
           "the trunk does not turn against the pelvis")
    return (f"{distance:.2f} m, {speed:.2f} m/s, bob {100 * bob:.1f} cm, stance {100 * duty:.0f} %, "
            f"double support {100 * double:.0f} %")


def check_turn(clip: Clip) -> str:
    check_soles(clip)
    turned = float(np.degrees(clip.yaw()[-1] - clip.yaw()[0]))
    expect(abs(turned - 360.0) < 0.5, f"turns {turned:.1f} degrees")
    wander = float(np.linalg.norm(clip.at["Hips"][:, :2] - clip.at["Hips"][0, :2], axis=1).max())
    expect(wander < 0.10, f"wanders {wander:.2f} m")
    steps = sum(len(contact_runs(clip, side)) - 1 for side in ("Left", "Right"))
    expect(steps == 12, f"{steps} steps")
    return f"{turned:.1f} degrees in {steps} steps"


def check_squat(clip: Clip) -> str:
    check_planted(clip, "squat")
    z = clip.at["Hips"][:, 2]
    lows = [k for k in range(1, len(z) - 1) if z[k] <= z[k - 1] and z[k] < z[k + 1] and z[k] < 0.6]
    expect(len(lows) == 2, f"{len(lows)} squats")
    deepest = int(z.argmin())
    knee = clip.at["LeftLeg"][deepest, 2] - clip.at["LeftUpLeg"][deepest, 2]
    expect(knee > -0.12, "thighs stay far from level")
    expect(clip.at["LeftHand"][deepest, 0] - clip.at["LeftArm"][deepest, 0] > 0.35, "arms do not reach forward")
    return f"hips down to {z.min():.2f} m"


def check_wave(clip: Clip) -> str:
    check_planted(clip, "wave")
    hand, shoulder, other = clip.at["RightHand"], clip.at["RightArm"], clip.at["LeftHand"]
    expect(float((hand - shoulder)[45:85, 2].min()) > 0.1, "the right hand is not up")
    expect(float((other - clip.at["LeftArm"])[:, 2].max()) < -0.3, "the left hand goes up")
    side = hand[38:84, 1] - shoulder[38:84, 1]
    turns = int(np.sum(np.diff(np.sign(np.diff(side))) != 0))
    expect(turns >= 4, f"the hand changes direction {turns} times only")
    return f"{turns} changes of direction"


def check_get_up(clip: Clip) -> str:
    hips, head = clip.at["Hips"], clip.at["Head"]
    expect(max(hips[0, 2], head[0, 2]) < 0.16, "does not start lying")
    expect(clip.turn["Hips"][0, 2, 1] > 0.95, "does not start on the back")
    expect(hips[-1, 2] > 0.88 and head[-1, 2] > 1.5, "does not end standing")
    expect(float(np.linalg.norm(hips[-8:] - hips[-1], axis=1).max()) < 0.005, "does not end at rest")
    knee = clip.at["RightLeg"]
    kneeling = (np.abs(knee[:, 2] - 0.055) < 0.01) & (hips[:, 2] > 0.35)
    expect(int(kneeling.sum()) > 45, "the right knee does not carry")
    moved = np.linalg.norm(np.diff(knee[:, :2], axis=0), axis=1)[kneeling[1:] & kneeling[:-1]]
    expect(float(np.median(moved)) < 0.001, "the planted knee slides")
    for side in ("Left", "Right"):
        expect(int((clip.at[side + "Hand"][:, 2] < 0.04).sum()) > 30, f"the {side.lower()} hand does not rest on the floor")
    return f"hips {hips[0, 2]:.2f} to {hips[-1, 2]:.2f} m, {kneeling.sum() / FPS:.1f} s on the knee"


CHECKS = {"walk": check_walk, "turn_in_place": check_turn, "squat": check_squat, "wave": check_wave, "get_up": check_get_up}


def main() -> int:
    if len(sys.argv) != 2:
        print("usage: check_samples.py FOLDER", file=sys.stderr)
        return 2
    folder, failed = pathlib.Path(sys.argv[1]), False
    paths = {name: folder / f"{name}.bvh" for name in CHECKS}
    for name, path in paths.items():
        try:
            expect(path.is_file(), "missing")
            clip = Clip(path)
            check_form(clip, name)
            step = check_smooth(clip)
            check_sides(clip)
            depth = check_floor(clip, 0.02)
            print(f"{path}: {CHECKS[name](clip)}; largest joint step {step:.2f} rad, lowest point {1000 * depth:.0f} mm")
        except Broken as broken:
            print(f"{path}: {broken}", file=sys.stderr)
            failed = True
    size = sum(path.stat().st_size for path in paths.values() if path.is_file())
    if size >= 1_000_000:
        print(f"{folder}: {size} bytes of clips, 1 MB is the limit", file=sys.stderr)
        failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
