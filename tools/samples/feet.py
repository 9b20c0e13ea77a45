"""Footsteps: where and when each foot stands, and the movement of the foot through stance and swing.

World frame: x forward, y left, z up, metres, seconds, radians. Foot pitch is positive with the toes up.
"""

from dataclasses import dataclass

import numpy as np

from body import ANKLE_HEIGHT, BALL, HEEL, rot_y, rot_z
from curves import KeyCurve, quintic, ramp, state_at
from pose import Leg

Array = np.ndarray


@dataclass
class Stance:
    """One ground contact: the ankle's place above the flat foot, and the events of the foot rocker."""

    x: float
    y: float
    yaw: float
    strike: float  # first contact
    flat: float  # sole down
    heel_off: float
    toe_off: float
    strike_pitch: float  # positive: on the heel; negative: on the ball
    push_pitch: float  # heel rise at toe-off, positive


class FootTrack:
    """Ankle, foot rotation and toe bend of one foot over its stances.

    In stance the foot turns about the heel (toes up) or the ball (heel up), which stay where they are; the
    pitch is exactly zero and at rest in between, so the change of pivot is smooth. The swing is a quintic
    that leaves and meets the stance movement with its speed and acceleration, plus a rise of `lift` metres
    shaped s^3 (1 - s)^tail: the greater `tail`, the sooner the foot is up. `early` is the greatest heel rise
    (just after toe-off) over that at toe-off, `swing_pitch` the pitch in late mid-swing.
    """

    def __init__(self, stances: list[Stance], lift: float, swing_pitch: float, early: float = 1.12, tail: int = 3) -> None:
        self.stances, self.tail = stances, tail
        top = 3.0 / (3.0 + tail)
        self.lift = lift / (top**3 * (1.0 - top) ** tail)
        times: list[float] = []
        values: list[float] = []
        for k, s in enumerate(stances):
            if k > 0:
                times += [s.strike, s.flat]
                values += [s.strike_pitch, 0.0]
            if k + 1 < len(stances):
                swing = stances[k + 1].strike - s.toe_off
                after = stances[k + 1].strike_pitch
                times += [s.heel_off, s.heel_off + 0.55 * (s.toe_off - s.heel_off), s.toe_off]
                times += [s.toe_off + part * swing for part in (0.17, 0.62, 0.85)]
                values += [0.0, -0.175 * s.push_pitch, -s.push_pitch]
                values += [-early * s.push_pitch, swing_pitch, after + 0.1 * abs(after)]
        self.pitch = KeyCurve(times, values) if len(times) > 1 else (lambda t: 0.0)

    def planted(self, t: float) -> bool:
        return any(s.strike <= t <= s.toe_off for s in self.stances)

    def _stance_ankle(self, s: Stance, t: float) -> Array:
        level, pitch = rot_z(s.yaw), float(self.pitch(t))
        pivot = HEEL if pitch > 0.0 else BALL
        return np.array([s.x, s.y, ANKLE_HEIGHT]) + level @ (pivot - rot_y(-pitch) @ pivot)

    def _bend(self, t: float) -> float:
        return max(-float(self.pitch(t)), 0.0)

    def state(self, t: float) -> tuple[Array, float, float, float]:
        """Ankle position, foot yaw, foot pitch and toe extension at t."""
        k = max((i for i, s in enumerate(self.stances) if s.strike <= t), default=0)
        now, pitch = self.stances[k], float(self.pitch(t))
        if t <= now.toe_off or k + 1 == len(self.stances):
            return self._stance_ankle(now, t), now.yaw, pitch, self._bend(t)
        after = self.stances[k + 1]
        span = after.strike - now.toe_off
        s = (t - now.toe_off) / span
        ankle = quintic(s, span, state_at(lambda u: self._stance_ankle(now, u), now.toe_off),
                        state_at(lambda u: self._stance_ankle(after, u), after.strike))
        ankle = ankle + np.array([0, 0, self.lift * s**3 * (1.0 - s) ** self.tail])
        yaw = now.yaw + (after.yaw - now.yaw) * ramp(t, now.toe_off, after.strike)
        # The toes meet the floor bent only if the landing is on the ball of the foot.
        landing = state_at(self._bend, after.strike) if after.strike_pitch < 0.0 else (0.0, 0.0, 0.0)
        return ankle, yaw, pitch, float(quintic(s, span, state_at(self._bend, now.toe_off), landing))

    def leg(self, t: float, forward: Array) -> Leg:
        """Leg target; the knee points between the foot's and the pelvis' `forward`."""
        ankle, yaw, pitch, toe = self.state(t)
        return Leg(ankle, rot_z(yaw) @ rot_y(-pitch), toe, rot_z(yaw)[:, 0] + forward)


def standing_foot(x: float, y: float, yaw: float) -> FootTrack:
    """A foot that stays flat."""
    return FootTrack([Stance(x, y, yaw, -1e9, -1e9, 1e9, 1e9, 0.0, 0.0)], 0.0, 0.0)
