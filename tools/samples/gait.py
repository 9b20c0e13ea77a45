"""Stepping motions: walk, run and turning on the spot, planned as footsteps in the world."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from body import SHIN, SIDES, THIGH, rot_x, rot_y, rot_z
from curves import KeyCurve, Spline, keys, smoothed
from feet import FootTrack, Stance
from pose import Arm, Pose, joint_offset, side_sign

Array = np.ndarray
deg = np.radians


@dataclass
class Motion:
    """A movement: its pose at any time in [0, duration] seconds."""

    duration: float
    pose: Callable[[float], Pose]


def pelvis_height(feet: dict[str, FootTrack], place: Callable[[float], Array], turn: Callable[[float], Array],
                  duration: float, straight: float, width: float, sharp: float = 300.0) -> Spline:
    """Hips height that the legs allow: a soft minimum over both legs stretched to `straight` of their length,
    blurred over `width` seconds. It makes the pelvis vault over the stance leg and dip in double support."""

    def limit(t: float) -> float:
        rotation, total = turn(t), 0.0
        for side in SIDES:
            ankle = feet[side].state(t)[0]
            hip = joint_offset(side + "UpLeg", rotation)
            flat = place(t)[:2] + hip[:2] - ankle[:2]
            top = ankle[2] + np.sqrt(max((straight * (THIGH + SHIN)) ** 2 - flat @ flat, 0.01)) - hip[2]
            total += np.exp(-sharp * (top - 0.9))
        return 0.9 - np.log(total) / sharp

    return smoothed(limit, duration, width, 0.025)


def walk() -> Motion:
    """Ten seconds: stand, walk straight ahead at 1.2 m/s with fourteen steps, stop and stand."""
    duration, step_time, step = 10.0, 0.515, 0.618
    half_width, toe_out = 0.058, deg(6.0)
    strikes = [1.50 + step_time * i for i in range(13)]
    strikes.append(strikes[-1] + 0.60)
    forward = [0.40] + [0.40 + step * i for i in range(1, 12)]
    forward += [forward[-1] + 0.46, forward[-1] + 0.46]
    sizes = [0.7] + [1.0] * 11 + [0.9, 0.4]
    owner = ["Right" if i % 2 == 0 else "Left" for i in range(len(strikes))]

    feet = {}
    for side in SIDES:
        sign = side_sign(side)
        mine = [i for i in range(len(strikes)) if owner[i] == side]
        # The stance that ends at step i is left while the other foot's step i - 1 has just landed.
        leave = [strikes[i] - 0.39 if i else strikes[0] - 0.45 for i in mine]
        rise = [strikes[i] - 0.605 if i else strikes[0] - 0.72 for i in mine]
        push = [deg(20.0 + 22.0 * sizes[i]) if i else deg(24.0) for i in mine]
        stances = [Stance(0.0, sign * half_width, sign * toe_out, -1e9, -1e9, rise[0], leave[0], 0.0, push[0])]
        for n, i in enumerate(mine):
            last = n + 1 == len(mine)
            stances.append(Stance(forward[i], sign * half_width, sign * toe_out, strikes[i], strikes[i] + 0.080,
                                  1e9 if last else rise[n + 1], 1e9 if last else leave[n + 1],
                                  deg(18.0) * sizes[i], 0.0 if last else push[n + 1]))
        feet[side] = FootTrack(stances, 0.030, deg(2.0), 1.28, 6)

    # Pelvis: between the feet in each double support, over (but inside) the stance foot in between.
    sway = 0.021
    knots = [(0.0, 0.035, 0.0), (0.45, 0.035, 0.0), (0.80, 0.030, -0.010), (1.12, 0.075, 0.034)]
    for i, strike in enumerate(strikes):
        last_place = forward[i - 1] if i else 0.0
        sign = side_sign(owner[i])
        if i + 1 < len(strikes):
            knots.append((strike + 0.065, 0.5 * (last_place + forward[i]) + 0.050, 0.0))
            knots.append((strike + 0.32, forward[i] + (0.055 if i + 2 < len(strikes) else 0.0), sign * sway))
    end = forward[-1] + 0.035
    knots += [(strikes[-1] + 0.05, end - 0.012, -0.010), (strikes[-1] + 0.75, end, 0.0), (duration, end, 0.0)]
    path = Spline([k[0] for k in knots], [k[1:] for k in knots])

    # Keys at the heel strikes; half-way between them the pelvis passes through level and straight.
    twists, rolls, swings = [(0.0, 0.0), (0.9, 0.0)], [(0.0, 0.0), (0.75, 0.0)], [(0.0, 0.0), (0.95, 0.0)]
    for i, (strike, size) in enumerate(zip(strikes, sizes)):
        sign = side_sign(owner[i])
        twists.append((strike, -sign * size * deg(5.5)))  # the landing side of the pelvis is forward
        rolls.append((strike + 0.14, sign * size * deg(4.0)))  # the side that has just left the floor drops
        swings.append((strike + 0.02, -sign * size))  # +1: left arm forward
    quiet = [(strikes[-1] + 0.85, 0.0), (duration, 0.0)]
    twist, roll, swing = (keys(*c, *quiet) for c in (twists, rolls, swings))
    going = KeyCurve([0.0, 0.7, 1.6, strikes[-2], strikes[-1] + 0.8, duration], [0.0, 0.0, 1.0, 1.0, 0.0, 0.0])

    def turn(t: float) -> Array:
        return rot_z(float(twist(t))) @ rot_y(deg(3.0 + 2.0 * float(going(t)))) @ rot_x(float(roll(t)))

    def place(t: float) -> Array:
        return path(t)

    height = pelvis_height(feet, place, turn, duration, 0.995, 0.030)

    def pose(t: float) -> Pose:
        pelvis = np.array([*place(t), float(height(t))])
        rotation = turn(t)
        a, g = float(swing(t)), float(going(t))
        # The shoulders turn against the pelvis by about as much; the neck keeps the face ahead.
        trunk = np.array([deg(-3.0 + 1.0 * g), -0.85 * float(roll(t)), -float(twist(t)) - deg(4.0) * a])
        neck = np.array([deg(-2.0 * g), -0.15 * float(roll(t)), 0.9 * deg(4.0) * a])
        arms = {}
        for side in SIDES:
            s = side_sign(side) * a
            late = side_sign(side) * float(swing(t - 0.06))
            arms[side] = Arm(flexion=deg(2.0 * (1 - g) - 1.0 * g + 20.0 * s), abduction=deg(11.0 - 1.5 * abs(s)),
                             rotation=deg(8.0 + 5.0 * s), elbow=deg(14.0 + 10.0 * g + 11.0 * late),
                             pronation=deg(25.0), wrist=deg(4.0), protraction=deg(3.0 * s))
        legs = {side: feet[side].leg(t, rotation[:, 0]) for side in SIDES}
        return Pose(pelvis, rotation, legs, arms, trunk, neck)

    return Motion(duration, pose)


def turn_in_place() -> Motion:
    """Six seconds: twelve small steps turn the body once around to the left."""
    duration, steps, step_time, angle = 6.0, 12, 0.42, deg(60.0)
    half_width, toe_out, back = 0.085, deg(7.0), 0.035
    strikes = [0.90 + step_time * i for i in range(steps)]
    feet = {}
    for side in SIDES:
        sign = side_sign(side)
        mine = [i for i in range(steps) if (i % 2 == 0) == (side == "Left")]

        def stance(yaw: float, strike: float, off: float) -> Stance:
            # Feet stay on either side of the vertical axis through the pelvis, the ankles behind it.
            spot = rot_z(yaw) @ np.array([-back, sign * half_width, 0.0])
            return Stance(spot[0], spot[1], yaw + sign * toe_out, strike, strike + 0.07, off - 0.13, off, deg(-9.0), deg(24.0))

        stances = [stance(0.0, -1e9, strikes[mine[0]] - 0.31)]
        for n, i in enumerate(mine):
            off = strikes[mine[n + 1]] - 0.31 if n + 1 < len(mine) else 1e9
            stances.append(stance(angle * (n + 1), strikes[i], off))
        feet[side] = FootTrack(stances, 0.045, deg(-4.0), tail=4)

    yaw_keys = [(0.0, 0.0), (0.45, 0.0)] + [(s - 0.06, 0.5 * angle * (i + 0.75)) for i, s in enumerate(strikes)]
    yaw = Spline(*zip(*(yaw_keys + [(strikes[-1] + 0.55, 2 * np.pi), (duration, 2 * np.pi)])))
    sway_keys = [(0.0, 0.0), (0.3, 0.0)]
    for i, strike in enumerate(strikes):
        sway_keys.append((strike - 0.16, -0.026 if i % 2 == 0 else 0.026))
    sway = Spline(*zip(*(sway_keys + [(strikes[-1] + 0.5, 0.0), (duration, 0.0)])))

    def place(t: float) -> Array:
        return (rot_z(float(yaw(t))) @ np.array([0.0, float(sway(t)), 0.0]))[:2]

    def turn(t: float) -> Array:
        return rot_z(float(yaw(t))) @ rot_x(-1.4 * float(sway(t))) @ rot_y(deg(3.0))

    height = pelvis_height(feet, place, turn, duration, 0.990, 0.045)
    ahead = Spline([0.0, 0.15, 0.75, strikes[-2], strikes[-1] + 0.4, duration],
                   [0.0, 0.0, deg(24.0), deg(24.0), 0.0, 0.0])

    def pose(t: float) -> Pose:
        lead, s = float(ahead(t)), float(sway(t)) / 0.026
        arms = {side: Arm(flexion=deg(3.0) - side_sign(side) * deg(4.0) * s, abduction=deg(13.0) + 0.18 * lead,
                          rotation=deg(8.0), elbow=deg(20.0) + 0.3 * lead, pronation=deg(25.0)) for side in SIDES}
        rotation = turn(t)
        legs = {side: feet[side].leg(t, rotation[:, 0]) for side in SIDES}
        return Pose(np.array([*place(t), float(height(t))]), rotation, legs, arms,
                    np.array([deg(-3.0), 0.030 * s, 0.35 * lead]), np.array([0.0, 0.0, 0.75 * lead]))

    return Motion(duration, pose)


def run() -> Motion:
    """Four seconds of steady running at 2.6 m/s with flight phases; begins and ends in mid-run."""
    duration, step_time, speed = 4.0, 0.37, 2.6
    contact, count = 0.225, 15
    strikes = [-0.9 + step_time * i for i in range(count)]
    feet = {}
    for side in SIDES:
        sign = side_sign(side)
        stances = []
        for i, strike in enumerate(strikes):
            if (i % 2 == 0) == (side == "Left"):
                stances.append(Stance(speed * strike + 0.20, sign * 0.035, sign * deg(5.0), strike, strike + 0.06,
                                      strike + 0.09, strike + contact, deg(7.0), deg(38.0)))
        feet[side] = FootTrack(stances, 0.14, deg(-6.0), 1.6)

    def phase(t: float) -> float:
        """Steps since the first strike; even at left strikes."""
        return (t - strikes[0]) / step_time

    def turn(t: float) -> Array:
        p = np.pi * phase(t)
        return rot_z(-deg(7.0) * np.cos(p)) @ rot_y(deg(10.0)) @ rot_x(deg(3.5) * np.sin(p))

    def pose(t: float) -> Pose:
        p = np.pi * phase(t)
        # Lowest in mid-stance, highest in mid-flight; 3.4 cm at this cadence peaks at about 1 g, as flight must.
        bob = -0.034 * np.cos(2.0 * p - 2.0 * np.pi * 0.5 * contact / step_time)
        pelvis = np.array([speed * t, 0.012 * np.sin(p), 0.862 + bob])
        rotation, swing = turn(t), -np.cos(p - 0.15)  # +1: left arm forward
        arms = {side: Arm(flexion=deg(-6.0 + 32.0 * side_sign(side) * swing), abduction=deg(14.0), rotation=deg(18.0),
                          elbow=deg(88.0 + 12.0 * side_sign(side) * swing), pronation=deg(10.0)) for side in SIDES}
        legs = {side: feet[side].leg(t, rotation[:, 0]) for side in SIDES}
        twist = deg(7.0) * np.cos(p)
        return Pose(pelvis, rotation, legs, arms, np.array([deg(2.0), -deg(3.0) * np.sin(p), 2.0 * twist]),
                    np.array([-deg(9.0), 0.0, -twist]))

    return Motion(duration, pose)
