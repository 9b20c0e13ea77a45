"""Smooth functions of time: the motions are built from these, so any frame rate samples the same movement.

Times are seconds. Values carry the unit of what they describe (metres, radians). Outside its keys every
curve holds the end value.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

Array = np.ndarray


def minimum_jerk(s: float) -> float:
    """The step 0 -> 1 over s in [0, 1] with zero speed and acceleration at both ends."""
    s = min(max(s, 0.0), 1.0)
    return s * s * s * (10.0 + s * (6.0 * s - 15.0))


def ramp(t: float, start: float, end: float) -> float:
    """Minimum-jerk step from 0 before `start` to 1 after `end`."""
    return minimum_jerk((t - start) / (end - start))


def window(t: float, rise: float, full: float, fall: float, end: float) -> float:
    """0, rising to 1 between `rise` and `full`, falling back between `fall` and `end`."""
    return ramp(t, rise, full) * (1.0 - ramp(t, fall, end))


def quintic(s: float, span: float, start: tuple, end: tuple) -> Any:
    """Quintic Hermite segment at s in [0, 1]; `start` and `end` are (value, velocity, acceleration), `span` its seconds."""
    p0, v0, a0 = start[0], start[1] * span, start[2] * span * span
    p1, v1, a1 = end[0], end[1] * span, end[2] * span * span
    d = p1 - p0 - v0 - 0.5 * a0
    dv, da = v1 - v0 - a0, a1 - a0
    c3 = 10.0 * d - 4.0 * dv + 0.5 * da
    c4 = -15.0 * d + 7.0 * dv - da
    c5 = 6.0 * d - 3.0 * dv + 0.5 * da
    return p0 + s * (v0 + s * (0.5 * a0 + s * (c3 + s * (c4 + s * c5))))


def state_at(function: Callable[[float], Any], t: float, step: float = 1e-3) -> tuple[Any, Any, Any]:
    """Value, velocity and acceleration of a smooth function at t, by central differences."""
    before, here, after = function(t - step), function(t), function(t + step)
    return here, (after - before) / (2.0 * step), (after - 2.0 * here + before) / (step * step)


class KeyCurve:
    """Quintic segments through key values, twice continuously differentiable and without overshoot.

    Speeds at the keys are harmonic means of the neighbouring slopes, zero at turning points and at the
    ends; accelerations at the keys are zero. Between two equal keys the curve is constant.
    """

    def __init__(self, times: Any, values: Any) -> None:
        self.times = np.asarray(times, float)
        self.values = np.asarray(values, float)
        spans = np.diff(self.times)
        if len(self.times) != len(self.values) or np.any(spans <= 0.0):
            raise ValueError(f"key times must increase, one value each: {list(times)}")
        slopes = (np.diff(self.values, axis=0).T / spans).T
        self.speeds = np.zeros_like(self.values)
        for k in range(1, len(self.times) - 1):
            a, b = slopes[k - 1], slopes[k]
            same = a * b > 0.0
            total = np.where(same, a + b, 1.0)
            self.speeds[k] = np.where(same, 2.0 * a * b / total, 0.0)

    def __call__(self, t: float) -> Array:
        k = int(np.searchsorted(self.times, t, side="right")) - 1
        if k < 0:
            return self.values[0]
        if k >= len(self.times) - 1:
            return self.values[-1]
        span = self.times[k + 1] - self.times[k]
        zero = np.zeros_like(self.values[k])
        return quintic((t - self.times[k]) / span, span,
                       (self.values[k], self.speeds[k], zero), (self.values[k + 1], self.speeds[k + 1], zero))


def keys(*pairs: tuple) -> KeyCurve:
    """A KeyCurve from (time, value) pairs."""
    return KeyCurve([p[0] for p in pairs], [p[1] for p in pairs])


class Spline:
    """Cubic spline through the keys, twice continuously differentiable, at rest at both ends."""

    def __init__(self, times: Any, values: Any) -> None:
        self.times = np.asarray(times, float)
        self.values = np.asarray(values, float)
        n, h = len(self.times), np.diff(self.times)
        matrix = np.zeros((n, n))
        right = np.zeros_like(self.values)
        matrix[0, 0] = matrix[-1, -1] = 1.0
        for k in range(1, n - 1):
            matrix[k, k - 1 : k + 2] = h[k], 2.0 * (h[k - 1] + h[k]), h[k - 1]
            right[k] = 3.0 * (h[k] * (self.values[k] - self.values[k - 1]) / h[k - 1]
                              + h[k - 1] * (self.values[k + 1] - self.values[k]) / h[k])
        self.speeds = np.linalg.solve(matrix, right)

    def __call__(self, t: float) -> Array:
        t = min(max(t, self.times[0]), self.times[-1])
        k = min(int(np.searchsorted(self.times, t, side="right")) - 1, len(self.times) - 2)
        h = self.times[k + 1] - self.times[k]
        s = (t - self.times[k]) / h
        p0, p1, v0, v1 = self.values[k], self.values[k + 1], self.speeds[k] * h, self.speeds[k + 1] * h
        return p0 + s * (v0 + s * (3.0 * (p1 - p0) - 2.0 * v0 - v1 + s * (2.0 * (p0 - p1) + v0 + v1)))


def smoothed(function: Callable[[float], float], duration: float, width: float, spread: float, rate: float = 240.0) -> Spline:
    """`function` over [0, duration]: its minimum within `spread` seconds, blurred by a Gaussian of deviation `width` seconds.

    The minimum keeps the blurred curve below a limit that dips sharply. Sampled on a fixed grid and splined,
    so the result does not depend on the frame rate written.
    """
    step = 1.0 / rate
    reach, near = int(np.ceil(4.0 * width * rate)), int(round(spread * rate))
    grid = np.arange(-reach, int(round(duration * rate)) + reach + 1) * step
    samples = np.array([function(min(max(t, 0.0), duration)) for t in grid])
    padded = np.pad(samples, near, mode="edge")
    lowest = np.lib.stride_tricks.sliding_window_view(padded, 2 * near + 1).min(axis=1)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) * step / width) ** 2)
    return Spline(grid[reach : len(grid) - reach], np.convolve(lowest, kernel / kernel.sum(), mode="valid"))
