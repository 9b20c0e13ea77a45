"""Scenes: their bodies and shapes, and the contacts of motions with them."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from retarget import _retarget


@dataclass(frozen=True, eq=False)
class SceneShape:
    """A solid shape of a body, in the frame of the body, metres."""

    type: str
    """`plane` (the half space below its z = 0), `box`, `sphere`, `capsule`, `cylinder`, `mesh`."""
    position: np.ndarray
    """(3,): origin of the shape."""
    rotation_wxyz: np.ndarray
    """(4,): body_from_shape, unit quaternion w x y z."""
    half_size: np.ndarray
    """(3,): of a box; else 0."""
    radius: float
    """Of a sphere, capsule or cylinder; else 0."""
    half_length: float
    """Of a cylinder, and of a capsule without its caps, along z; else 0."""
    vertices: np.ndarray = field(repr=False)
    """(V, 3): corners of a mesh, in the frame of the shape."""
    triangles: np.ndarray = field(repr=False)
    """(T, 3) int64: indices into vertices."""


@dataclass(frozen=True, eq=False)
class SceneBody:
    """A rigid body of a scene; Scene.positions and Scene.rotations_wxyz have its poses."""

    name: str
    moves: bool
    mass: float
    """kg; 0: unknown."""
    shapes: list[SceneShape]


class ContactLabels:
    """Contacts of a robot with surfaces, one column for each part of the body and surface.

    `str()` is the table of the command `retarget contacts`.
    """

    def __init__(self, frames: int, touches: list[tuple[str, str, str, int, int, bool]], text: str,
                 json_text: str) -> None:
        columns = sorted({touch[:3] for touch in touches})
        index = {column: i for i, column in enumerate(columns)}
        self.parts = [part for part, _, _ in columns]
        """Parts of the human by column: `left_hand`, `left_heel`, `seat`, ..."""
        self.links = [link for _, link, _ in columns]
        """Bodies of the robot by column."""
        self.surfaces = [surface for _, _, surface in columns]
        """Bodies of the scene by column; `floor`: the floor z = 0."""
        self.touching: np.ndarray = np.zeros((frames, len(columns)), dtype=bool)
        """(F, C) bool: in contact."""
        self.sliding: np.ndarray = np.zeros_like(self.touching)
        """(F, C) bool: in contact and moving over the surface."""
        for part, link, surface, begin, end, slides in touches:
            column = index[part, link, surface]
            self.touching[begin:end, column] = True
            self.sliding[begin:end, column] |= slides
        self._text = text
        self.json = json_text
        """The contacts as `retarget contacts --json` writes them."""

    @cached_property
    def data(self) -> dict[str, Any]:
        """The contacts as in their JSON: intervals of frames and seconds."""
        return json.loads(self.json)

    def __len__(self) -> int:
        return len(self.parts)

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        frames, columns = self.touching.shape
        return f"<retarget.ContactLabels: {columns} columns, {frames} frames>"


def load_scene(file: str | os.PathLike[str]) -> _retarget.Scene:
    """Reads a scene: MJCF, URDF, OBJ, STL, COLLADA, or JSON primitives (docs/world.md).

    A floor at z = 0 is left out, because every clip has one. `to_robot(scene=file)` uses the same
    files.

    Raises:
        InputError: a file that cannot be read, or without shapes; FileNotFoundError as well if
            the file does not exist.
    """
    return _retarget.load_scene(file)


def make_body(name: str, moves: bool, mass: float, shapes: list[dict[str, Any]]) -> SceneBody:
    """Called by the module."""
    return SceneBody(name, moves, mass, [SceneShape(**shape) for shape in shapes])


#: Called by the module.
make_labels = ContactLabels
