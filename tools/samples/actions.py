"""Motions on the spot: squat, wave, jump, sitting down and standing still."""

import numpy as np

from body import SIDES, rot_x, rot_y, rot_z
from curves import Spline, keys, quintic
from feet import FootTrack, Stance, standing_foot
from gait import Motion
from pose import Arm, Pose, side_sign

Array = np.ndarray
deg = np.radians

GRAVITY = 9.81
STAND = 0.919  # hips height of relaxed standing, metres: knees bent by about ten degrees
OVER_FEET = 0.035  # hips ahead of the ankles in balanced standing, metres


def _feet(half_width: float, toe_out: float) -> dict[str, FootTrack]:
    return {side: standing_foot(0.0, side_sign(side) * half_width, side_sign(side) * toe_out) for side in SIDES}


def _legs(feet: dict[str, FootTrack], t: float, turn: Array, part: float = 1.0) -> dict:
    return {side: feet[side].leg(t, part * turn[:, 0]) for side in SIDES}


def _breath(t: float) -> float:
    """Slow trunk movement of quiet standing, -1..1, starting at rest."""
    return float(np.sin(2.0 * np.pi * t / 4.0) ** 2)


def squat() -> Motion:
    """Five seconds: two deep squats, arms forward for balance, feet planted."""
    feet = _feet(0.17, deg(20.0))
    low, lower = 1.0, 1.06
    depth = keys((0.0, 0.0), (0.25, 0.0), (1.20, low), (1.40, low), (2.35, 0.03), (2.55, 0.03), (3.50, lower),
                 (3.70, lower), (4.70, 0.0), (5.0, 0.0))

    def pose(t: float) -> Pose:
        d = float(depth(t))
        # The hips go down and back while the trunk leans, so that the weight stays over the feet.
        pelvis = np.array([OVER_FEET - 0.225 * d + 0.04 * d * d, 0.0, STAND - 0.012 - 0.405 * d])
        turn = rot_y(deg(4.0 + 33.0 * d))
        arms = {side: Arm(flexion=deg(2.0 + 128.0 * d), abduction=deg(11.0 - 5.0 * d), rotation=deg(8.0 - 6.0 * d),
                          elbow=deg(14.0), pronation=deg(20.0 + 25.0 * d), protraction=deg(8.0 * d),
                          elevation=deg(4.0 * d)) for side in SIDES}
        return Pose(pelvis, turn, _legs(feet, t, turn, 0.25), arms, np.array([deg(-3.0 + 13.0 * d), 0.0, 0.0]),
                    np.array([deg(-34.0 * d), 0.0, 0.0]))

    return Motion(5.0, pose)


def wave() -> Motion:
    """Four seconds: the right hand is raised, waves and comes down; the weight shifts to the left leg."""
    feet = _feet(0.085, deg(8.0))
    raised = keys((0.0, 0.0), (0.20, 0.0), (1.05, 1.0), (2.95, 1.0), (3.80, 0.0), (4.0, 0.0))
    shift = keys((0.0, 0.0), (0.15, 0.0), (1.1, 1.0), (2.8, 1.0), (3.75, 0.0), (4.0, 0.0))
    strength = keys((0.0, 0.0), (0.80, 0.0), (1.25, 1.0), (2.75, 1.0), (3.15, 0.0), (4.0, 0.0))

    def pose(t: float) -> Pose:
        up, s = float(raised(t)), float(shift(t))
        beat = float(strength(t)) * np.sin(2.0 * np.pi * 1.9 * (t - 0.9))
        pelvis = np.array([OVER_FEET, 0.028 * s, STAND - 0.006 * s])
        turn = rot_z(deg(2.0) * s) @ rot_y(deg(3.0)) @ rot_x(deg(2.2) * s)
        lazy = Arm(flexion=deg(3.0 + 2.0 * s), rotation=deg(9.0), elbow=deg(15.0 + 2.0 * _breath(t)), pronation=deg(25.0))
        # Upper arm sideways and a little forward, forearm upright; waving turns the forearm about the upper arm's
        # axis and the wrist follows. The palm faces forward.
        arm = Arm(flexion=deg(2.0 + 20.0 * up), abduction=deg(11.0 + 55.0 * up), rotation=deg(8.0 - 88.0 * up + 6.0 * beat),
                  elbow=deg(14.0 + 94.0 * up + 20.0 * beat), pronation=deg(22.0 + 12.0 * up), wrist=deg(-10.0 * beat),
                  elevation=deg(9.0 * up))
        trunk = np.array([deg(-2.5 + 0.8 * _breath(t)), -deg(5.0) * s - deg(0.6) * beat, -deg(4.0) * s])
        neck = np.array([deg(1.0), deg(4.0) * s, deg(-3.0) * s])
        return Pose(pelvis, turn, _legs(feet, t, turn), {"Left": lazy, "Right": arm}, trunk, neck)

    return Motion(4.0, pose)


def stand_still() -> Motion:
    """Quiet standing with breathing; three seconds by default."""
    feet = _feet(0.085, deg(8.0))

    def pose(t: float) -> Pose:
        breath = _breath(t)
        turn = rot_y(deg(3.0))
        arms = {side: Arm(flexion=deg(3.0), rotation=deg(8.0), elbow=deg(14.0 + 1.0 * breath), pronation=deg(25.0))
                for side in SIDES}
        return Pose(np.array([OVER_FEET, 0.002 * breath, STAND]), turn, _legs(feet, t, turn), arms,
                    np.array([deg(-2.5 + 0.8 * breath), 0.0, 0.0]))

    return Motion(3.0, pose)


def jump() -> Motion:
    """Three seconds: crouch, take off, 0.35 s of ballistic flight, land on the balls of the feet, recover."""
    leave, flight = 1.30, 0.35
    land = leave + flight
    speed = 0.5 * GRAVITY * flight
    top = STAND + 0.03  # hips height at take-off, up on the toes, knees still bent: they straighten in the air
    feet = {}
    for side in SIDES:
        sign = side_sign(side)
        feet[side] = FootTrack([Stance(0.0, sign * 0.09, sign * deg(8.0), -1e9, -1e9, leave - 0.27, leave, 0.0, deg(42.0)),
                                Stance(0.0, sign * 0.09, sign * deg(8.0), land, land + 0.10, 1e9, 1e9, deg(-32.0), 0.0)],
                               0.175, deg(-42.0), 1.02)
    fall = -GRAVITY
    zero = (0.0, 0.0)
    # (time, height, velocity, acceleration): free fall from take-off to landing.
    states = [(0.0, STAND, *zero), (0.30, STAND, *zero), (0.90, STAND - 0.30, *zero), (1.00, STAND - 0.30, *zero),
              (leave, top, speed, fall), (land, top - 0.035, -speed, fall), (land + 0.26, STAND - 0.22, *zero),
              (land + 0.90, STAND, *zero), (3.0, STAND, *zero)]

    def height(t: float) -> float:
        if leave <= t < land:
            u = t - leave
            return top + speed * u - 0.5 * GRAVITY * u * u - 0.035 * (u / flight) ** 3
        for a, b in zip(states, states[1:]):
            if t <= b[0]:
                span = b[0] - a[0]
                return float(quintic((t - a[0]) / span, span, a[1:], b[1:]))
        return STAND

    lean = Spline([0.0, 0.3, 0.95, leave, land, land + 0.26, land + 0.9, 3.0], [0.0, 0.0, 1.0, 0.05, 0.15, 0.75, 0.0, 0.0])
    arm = Spline([0.0, 0.3, 0.90, leave, land, land + 0.4, land + 1.0, 3.0], [3.0, 3.0, -22.0, 125.0, 80.0, 25.0, 3.0, 3.0])

    def pose(t: float) -> Pose:
        c = float(lean(t))
        pelvis = np.array([OVER_FEET - 0.10 * c, 0.0, height(t)])
        turn = rot_y(deg(4.0 + 32.0 * c))
        flexion = deg(float(arm(t)))
        arms = {side: Arm(flexion=flexion, abduction=deg(12.0), rotation=deg(8.0), elbow=deg(22.0), pronation=deg(25.0))
                for side in SIDES}
        return Pose(pelvis, turn, _legs(feet, t, turn), arms, np.array([deg(-3.0 + 10.0 * c), 0.0, 0.0]),
                    np.array([deg(-22.0 * c), 0.0, 0.0]))

    return Motion(3.0, pose)


def sit() -> Motion:
    """Six seconds: sit down on a seat 0.45 m high, sit still, and stand up again; feet planted."""
    feet = _feet(0.10, deg(10.0))
    seated = keys((0.0, 0.0), (0.4, 0.0), (1.9, 1.0), (3.9, 1.0), (5.4, 0.0), (6.0, 0.0))
    lean = keys((0.0, 0.0), (0.35, 0.0), (1.35, 1.0), (2.2, 0.0), (3.3, 0.0), (4.25, 1.08), (5.4, 0.0), (6.0, 0.0))
    seat = 0.45 + 0.095  # hips joint above the seat

    def pose(t: float) -> Pose:
        s, c = float(seated(t)), float(lean(t))
        pelvis = np.array([OVER_FEET - 0.42 * s, 0.0, STAND + (seat - STAND) * s])
        turn = rot_y(deg(4.0 - 9.0 * s + 34.0 * c))
        arms = {side: Arm(flexion=deg(3.0 + 22.0 * s + 40.0 * c), abduction=deg(10.0), rotation=deg(10.0 + 12.0 * s),
                          elbow=deg(14.0 + 46.0 * s - 15.0 * c), pronation=deg(25.0 + 40.0 * s)) for side in SIDES}
        return Pose(pelvis, turn, _legs(feet, t, turn), arms, np.array([deg(-2.5 + 3.0 * s + 14.0 * c), 0.0, 0.0]),
                    np.array([deg(-24.0 * c), 0.0, 0.0]))

    return Motion(6.0, pose)
