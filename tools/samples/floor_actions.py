"""Motions with hands, knees or back on the floor: getting up, crawling and a cartwheel."""

import numpy as np

from body import ANKLE_HEIGHT, SHIN, SIDES, THIGH, rot_x, rot_y, rot_z, unit
from curves import KeyCurve, keys, minimum_jerk, ramp, window
from gait import Motion
from pose import Arm, Leg, Pose, flat_hand, hip_joint, middle_joint, rotation_between, side_sign

Array = np.ndarray
deg = np.radians

STAND = 0.919  # hips height of relaxed standing, metres
KNEE_HEIGHT = 0.055  # knee joint when kneeling, metres
WRIST_HEIGHT = 0.030  # wrist joint above a flat hand, metres


def shin_frame(hip: Array, ankle: Array, pole: Array) -> Array:
    """World rotation of the shin's anatomical frame."""
    knee = middle_joint(hip, ankle, THIGH, SHIN, pole)
    hinge, up = unit(np.cross(pole, ankle - hip)), unit(knee - ankle)
    return np.column_stack([np.cross(hinge, up), hinge, up])


def _behind_knee(knee: Array, azimuth: float, elevation: float) -> Array:
    """Ankle at the end of a shin that leaves the planted knee in this direction (radians)."""
    flat = np.cos(elevation)
    return knee + SHIN * np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])


def get_up() -> Motion:
    """Nine and a half seconds: lying on the back, sitting up with the hands beside the hips, turning to the right
    onto hands and right knee, half-kneeling with the left foot forward, standing (facing right of the start)."""
    knee = np.array([0.16, -0.42, KNEE_HEIGHT])  # where the right knee is planted
    folded = _behind_knee(knee, deg(84.0), deg(1.0))
    lifted = _behind_knee(knee, deg(86.0), deg(30.0))
    tucked = _behind_knee(knee, deg(88.0), deg(17.2))

    place = keys((0.0, (0, 0, 0.110)), (0.5, (0, 0, 0.110)), (1.25, (0.01, 0, 0.108)), (2.30, (0.03, 0, 0.104)),
                 (3.20, (0.00, -0.01, 0.125)), (4.30, (0.25, -0.33, 0.45)), (5.20, (0.25, -0.42, 0.47)),
                 (6.20, (0.25, -0.45, 0.48)), (7.20, (0.29, -0.68, 0.68)), (8.10, (0.295, -0.815, 0.885)),
                 (8.90, (0.28, -0.835, STAND)), (9.5, (0.28, -0.835, STAND)))
    # Yaw, pitch (forward) and roll (left side up) of the pelvis, degrees.
    attitude = keys((0.0, (0, -89, 0)), (0.5, (0, -89, 0)), (1.25, (0, -72, 0)), (2.30, (0, -14, 0)),
                    (3.20, (-52, 14, 14)), (4.30, (-86, 66, 0)), (5.20, (-90, 40, 0)), (6.20, (-90, 12, -2)),
                    (7.20, (-90, 30, 2)), (8.10, (-90, 9, 2)), (8.90, (-90, 3, 0)), (9.5, (-90, 3, 0)))
    trunk = keys((0.0, (0, 0, 0)), (0.5, (0, 0, 0)), (1.25, (26, 0, 0)), (2.30, (26, 0, 0)), (3.20, (26, 8, -16)),
                 (4.30, (20, 0, 0)), (5.20, (22, 0, 4)), (6.20, (6, 0, 0)), (7.20, (14, 0, 0)), (8.90, (-3, 0, 0)))
    neck = keys((0.0, (4, 0, 0)), (0.4, (4, 0, 0)), (1.10, (30, 0, 0)), (2.30, (2, 0, 0)), (3.20, (-14, 0, -14)),
                (4.30, (-48, 0, 0)), (5.30, (-30, 0, 0)), (6.20, (-4, 0, 0)), (7.20, (-20, 0, 0)), (8.80, (0, 0, 0)))
    ankles = {
        "Left": keys((0.0, (0.832, 0.115, 0.080)), (0.5, (0.832, 0.115, 0.080)), (0.95, (0.66, 0.125, 0.120)),
                     (1.35, (0.52, 0.13, ANKLE_HEIGHT)), (2.45, (0.52, 0.13, ANKLE_HEIGHT)), (2.80, (0.53, 0.07, 0.115)),
                     (3.15, (0.53, 0.00, ANKLE_HEIGHT)), (4.25, (0.53, 0.00, ANKLE_HEIGHT)), (4.70, (0.46, -0.44, 0.16)),
                     (5.15, (0.38, -0.80, ANKLE_HEIGHT)), (9.5, (0.38, -0.80, ANKLE_HEIGHT))),
        "Right": keys((0.0, (0.832, -0.115, 0.080)), (0.5, (0.832, -0.115, 0.080)), (0.98, (0.65, -0.125, 0.120)),
                      (1.42, (0.50, -0.13, ANKLE_HEIGHT)), (2.30, (0.50, -0.13, ANKLE_HEIGHT)), (2.75, (0.36, -0.06, 0.150)),
                      (3.25, folded), (4.95, folded), (5.40, lifted), (5.90, tucked), (6.60, tucked),
                      (7.15, tucked + (0, -0.07, 0.06)),
                      (7.75, (0.185, -0.45, 0.17)), (8.45, (0.18, -0.80, ANKLE_HEIGHT)), (9.5, (0.18, -0.80, ANKLE_HEIGHT))),
    }
    poles = {
        "Left": keys((0.0, (0.2, 0.10, 1)), (2.40, (0.2, 0.05, 1)), (3.20, (0.4, -0.1, 0.9)), (4.30, (0.75, -0.6, 0.45)),
                     (5.15, (0.08, -1, 0.5)), (7.0, (0.05, -1, 0.3)), (8.5, (0.12, -1, 0))),
        "Right": keys((0.0, (0.2, -0.10, 1)), (2.30, (0.2, -0.05, 1)), (3.20, (0.25, -1, 0.1)), (4.30, (0, -0.7, -0.7)),
                      (6.60, (0, -0.7, -0.7)), (7.40, (-0.05, -1, -0.2)), (8.5, (-0.12, -1, 0))),
    }
    # Yaw and pitch (toes up) of each foot in the world, degrees; the toes stay level while the ball is down.
    feet = {
        "Left": keys((0.0, (12, 68)), (0.5, (12, 68)), (0.95, (10, 30)), (1.35, (8, 0)), (2.45, (8, 0)), (3.15, (-28, 0)),
                     (4.35, (-28, 0)), (4.72, (-54, -18)), (5.15, (-84, 0)), (9.5, (-84, 0))),
        "Right": keys((0.0, (-12, 68)), (0.5, (-12, 68)), (0.98, (-10, 30)), (1.42, (-8, 0)), (2.30, (-8, 0)),
                      (5.0, (-92, -75)), (5.90, (-92, -75)), (6.65, (-92, -75)), (7.15, (-92, -66)), (7.85, (-94, -30)),
                      (8.40, (-97, 0)), (9.5, (-97, 0))),
    }
    toes = {"Left": keys((0.0, 0.0), (4.35, 0.0), (4.65, 12.0), (5.0, 0.0)),
            "Right": keys((0.0, 0.0), (2.4, 0.0), (3.1, -38.0), (5.0, -38.0), (5.90, 75.0), (6.65, 75.0), (7.15, 66.0),
                          (7.8, 12.0), (8.3, 0.0))}
    floor = WRIST_HEIGHT
    hands = {
        "Left": keys((0.0, (0.02, 0.275, floor)), (2.15, (0.02, 0.275, floor)), (2.72, (0.24, 0.05, 0.26)),
                     (3.30, (0.36, -0.38, 0.20)),
                     (3.85, (0.42, -0.74, floor)), (4.70, (0.42, -0.74, floor)), (5.25, (0.41, -0.70, 0.40)),
                     (5.75, (0.40, -0.70, 0.58)), (6.6, (0.40, -0.72, 0.58)), (7.4, (0.42, -0.78, 0.60))),
        "Right": keys((0.0, (0.02, -0.275, floor)), (2.25, (0.02, -0.275, floor)), (2.70, (0.04, -0.44, 0.13)),
                      (3.12, (0.07, -0.60, floor)), (4.85, (0.07, -0.60, floor)), (5.45, (0.05, -0.55, 0.28)),
                      (6.0, (0.05, -0.55, 0.40))),
    }
    elbows = {
        "Left": keys((0.0, (-0.1, 1, 0.25)), (0.8, (-0.1, 1, 0.25)), (2.2, (-1, 0.6, 0.1)), (3.2, (0.6, 0.8, 0)),
                     (4.3, (0.6, 0.8, 0.1)),
                     (5.7, (0.9, 0.5, 0))),
        "Right": keys((0.0, (-0.1, -1, 0.25)), (0.8, (-0.1, -1, 0.25)), (2.2, (-1, -0.6, 0.1)), (3.2, (-1, -0.2, 0.2)),
                      (4.3, (-0.6, 0.8, 0.1))),
    }
    headings = {"Left": keys((0.0, 0.0), (2.2, 0.0), (3.8, -80.0)), "Right": keys((0.0, 0.0), (2.25, 0.0), (3.12, -75.0))}

    def pose(t: float) -> Pose:
        yaw, pitch, roll = deg(attitude(t))
        turn = rot_z(yaw) @ rot_y(pitch) @ rot_x(roll)
        pelvis = place(t).copy()
        # While the right knee is planted the pelvis keeps the length of the thigh away from it.
        kneeling = window(t, 2.6, 3.2, 6.3, 7.1)
        hip = hip_joint(pelvis, turn, "Right")
        away = hip - knee
        pelvis += kneeling * (THIGH / np.sqrt(away @ away) - 1.0) * away
        legs, arms = {}, {}
        for side in SIDES:
            hip, ankle, pole = hip_joint(pelvis, turn, side), ankles[side](t), poles[side](t)
            if side == "Right":
                pole = unit(pole) + kneeling * (unit(knee - 0.5 * (hip + ankle)) - unit(pole))
            foot_yaw, foot_pitch = deg(feet[side](t))
            foot = rot_z(foot_yaw) @ rot_y(-foot_pitch)
            if side == "Right":
                # Folded under the body the foot follows the shin, pointed.
                folding = window(t, 2.35, 3.0, 5.0, 5.8)
                foot = rotation_between(foot, shin_frame(hip, ankle, pole) @ rot_y(deg(50.0)), folding)
            legs[side] = Leg(ankle, foot, deg(float(toes[side](t))), pole)
            hold = 1.0 - (ramp(t, 6.5, 7.8) if side == "Left" else ramp(t, 4.9, 6.1))
            flat = 1.0 - ramp(t, 4.75, 5.4)
            if side == "Left":
                flat *= 1.0 - window(t, 2.15, 2.85, 3.2, 3.80)
            arms[side] = Arm(flexion=deg(3.0), rotation=deg(8.0), elbow=deg(14.0), pronation=deg(25.0),
                             target=hands[side](t),
                             pole=elbows[side](t), weight=hold, hand=flat_hand(side, deg(float(headings[side](t)))),
                             hand_weight=flat)
        return Pose(pelvis, turn, legs, arms, deg(trunk(t)), deg(neck(t)))

    return Motion(9.5, pose)


def _pace(t: float, period: float, swing: float) -> tuple[float, float]:
    """Cycles done (stepwise, smooth) and height 0..1 of a limb that swings in the last `swing` seconds of each period."""
    cycle, phase = divmod(t, period)
    s = max(phase - (period - swing), 0.0) / swing
    return cycle + minimum_jerk(s), 64.0 * (s * (1.0 - s)) ** 3


def crawl() -> Motion:
    """Six seconds of crawling forward on hands and knees, diagonal limbs together, 0.28 m/s."""
    period, swing, stride = 1.2, 0.5, 0.336
    speed = stride / period
    sole = deg(50.0)  # pointed feet

    def pose(t: float) -> Pose:
        sway = np.sin(2.0 * np.pi * t / period)
        turn = rot_z(deg(3.0) * sway) @ rot_y(deg(82.0)) @ rot_x(deg(-4.0) * sway)
        pelvis = np.array([speed * t, 0.012 * sway, KNEE_HEIGHT + THIGH - 0.001])
        legs, arms = {}, {}
        for side in SIDES:
            sign = side_sign(side)
            done, rise = _pace(t + (0.0 if side == "Left" else 0.5 * period), period, swing)
            start = 0.0 if side == "Left" else -0.5
            knee = np.array([stride * (done + start) + 0.10, 0.105 * sign, KNEE_HEIGHT])
            hip = hip_joint(pelvis, turn, side)
            knee = hip + THIGH * unit(knee - hip)
            ankle = knee + SHIN * unit(np.array([-1.0, -0.02 * sign, 0.025 + 0.06 * rise]))
            pole = unit(knee - 0.5 * (hip + ankle))
            legs[side] = Leg(ankle, shin_frame(hip, ankle, pole) @ rot_y(sole), deg(-38.0), pole)
            done, rise = _pace(t + (0.5 * period if side == "Left" else 0.0), period, swing)
            start = -0.5 if side == "Left" else 0.0
            wrist = np.array([stride * (done + start) + 0.60, 0.185 * sign, WRIST_HEIGHT + 0.06 * rise])
            arms[side] = Arm(target=wrist, pole=np.array([-1.0, 0.5 * sign, 0.1]), weight=1.0,
                             hand=flat_hand(side, -0.1 * sign), hand_weight=1.0)
        return Pose(pelvis, turn, legs, arms, np.array([deg(6.0), 0.0, deg(-4.0) * sway]), np.array([deg(-48.0), 0.0, 0.0]))

    return Motion(6.0, pose)


def cartwheel() -> Motion:
    """Four seconds, best effort: a cartwheel to the left (along world x, facing -y so that the root stays clear of gimbal lock)."""
    spin = keys((0.0, 0.0), (0.8, 0.0), (1.25, 42.0), (1.65, 120.0), (1.95, 195.0), (2.30, 275.0), (2.75, 340.0),
                (3.2, 360.0), (4.0, 360.0))
    along = KeyCurve([0.0, 0.5, 1.25, 1.65, 1.95, 2.30, 2.75, 3.3, 4.0],
                     [0.0, 0.0, 0.42, 0.92, 1.28, 1.66, 2.05, 2.30, 2.30])
    height = KeyCurve([0.0, 0.5, 1.25, 1.65, 1.95, 2.30, 2.75, 3.3, 4.0],
                      [0.919, 0.919, 0.82, 0.97, 1.09, 0.97, 0.82, 0.919, 0.919])
    ground = {"Left": keys((0.0, 0.10), (0.5, 0.10), (1.0, 0.62), (2.0, 0.62), (2.1, 2.42), (4.0, 2.42)),
              "Right": keys((0.0, -0.10), (1.8, -0.10), (1.9, 2.18), (4.0, 2.18))}
    aloft = {"Left": (1.35, 1.70, 2.45, 2.85), "Right": (1.10, 1.45, 2.05, 2.50)}
    palm = {"Left": 1.10, "Right": 1.42}
    down = {"Left": (1.10, 1.65, 1.90, 2.40), "Right": (1.35, 1.80, 2.10, 2.60)}

    def pose(t: float) -> Pose:
        turn = rot_z(-np.pi / 2.0) @ rot_x(-deg(float(spin(t))))
        pelvis = np.array([float(along(t)), 0.03, float(height(t))])
        legs, arms = {}, {}
        for side in SIDES:
            sign = side_sign(side)
            hip = hip_joint(pelvis, turn, side)
            free = window(t, *aloft[side])
            planted = np.array([float(ground[side](t)), 0.0, ANKLE_HEIGHT + 0.10 * window(t, 0.5, 0.7, 0.8,
                                                                                          1.0) * (sign > 0)])
            star = hip + 0.80 * (turn @ unit(np.array([0.0, 0.62 * sign, -0.80])))
            ankle = planted + free * (star - planted)
            line = ankle - hip
            limit = 0.993 * (THIGH + SHIN)
            distance = np.sqrt(line @ line)
            ankle = hip + line * min(1.0, limit / distance)
            level = rot_z(-np.pi / 2.0 + sign * deg(10.0))
            pointed = turn @ rot_x(sign * deg(35.0)) @ rot_y(deg(40.0))
            legs[side] = Leg(ankle, rotation_between(level, pointed, free), 0.0, turn[:, 0] + 0.3 * sign * turn[:, 1])
            up = window(t, 0.25, 0.95, 2.6, 3.5)
            arms[side] = Arm(flexion=deg(3.0), abduction=deg(11.0 + 150.0 * up), elbow=deg(14.0 - 4.0 * up),
                             pronation=deg(25.0),
                             elevation=deg(14.0 * up), target=np.array([palm[side], 0.0, 0.19]),
                             pole=turn[:, 1] * sign - turn[:, 0],
                             weight=window(t, *down[side]))
        return Pose(pelvis, turn, legs, arms, np.zeros(3), np.array([deg(-8.0) * window(t, 0.8, 1.3, 2.3, 2.8), 0.0, 0.0]))

    return Motion(4.0, pose)
