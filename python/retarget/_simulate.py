"""Motions replayed in a physics simulation."""

from __future__ import annotations

import json
from functools import cached_property
from typing import Any

from retarget import _retarget


class Simulation:
    """A simulated motion and how well it follows its reference (docs/simulation.md)."""

    def __init__(self, motion: _retarget.Motion, json_text: str) -> None:
        self.motion = motion
        """The simulated motion, in the frames of its reference."""
        self.json = json_text
        """The report as `retarget simulate --json` prints it."""

    @cached_property
    def data(self) -> dict[str, Any]:
        """The report, as in its JSON."""
        return json.loads(self.json)

    @property
    def fell(self) -> bool:
        """Whether the robot fell or lost its reference."""
        return self.data["fell"]

    def __repr__(self) -> str:
        data = self.data
        end = f"fell at {data['fall_time_s']:.2f} s" if data["fell"] else "no fall"
        return f"<retarget.Simulation: {data['robot']}, {data['frames']} frames, {end}>"


def simulate(motion: _retarget.Motion) -> Simulation:
    """Replays a motion in MuJoCo under a whole-body controller with torque limits.

    Args:
        motion: of a robot with legs, soles and masses, at least three frames.

    Raises:
        InputError: fewer than three frames.
        ConfigError: the robot has a fixed base, no soles or no masses.
    """
    return Simulation(*_retarget.simulate(motion))
