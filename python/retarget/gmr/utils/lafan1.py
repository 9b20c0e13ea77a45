"""BVH files in the format of the published class: one dictionary of bodies per frame."""

from __future__ import annotations

import math
import os

import numpy as np

import retarget
from retarget._errors import InputError, UsageError
from retarget.gmr._frames import Frame, frames_of

# The published package assumes 1.75 m for every body.
_HEIGHT = 1.75
_CENTIMETRE = 0.01
_ANY = "retarget.to_robot(retarget.load(file), robot) accepts any skeleton"
_TOES = {"lafan1": "Toe", "nokov": "ToeBase"}


def _z_up(positions: np.ndarray) -> np.ndarray:
    """Converts (..., 3) from centimetres, Y up, to metres, Z up."""
    x, y, z = np.moveaxis(positions, -1, 0)
    return np.stack([x, -z, y], axis=-1) * _CENTIMETRE


def _turned_z_up(rotations: np.ndarray) -> np.ndarray:
    """Rotates (..., 4) w x y z by 90 degrees about x."""
    w, x, y, z = np.moveaxis(rotations, -1, 0)
    half = math.sqrt(0.5)
    return np.stack([half * w - half * x, half * x + half * w,
                     half * y - half * z, half * z + half * y], axis=-1)


def load_bvh_file(bvh_file: str | os.PathLike[str],
                  format: str = "lafan1") -> tuple[list[Frame], float]:
    """Reads a BVH file with LAFAN1's joint names, Y up, in centimetres.

    Returns all frames of the file without resampling. retarget.to_robot recognises files of other
    kinds, units and axes.

    Args:
        bvh_file: the file.
        format: "lafan1", or "nokov", whose toes are called ToeBase.

    Returns:
        (frames, height): for every frame {joint: [position (3,), quaternion (4,)]}, world, metres,
        Z up, quaternions w x y z; with LeftFootMod and RightFootMod, which have the positions of
        the ankles and the rotations of the toes. The height is always 1.75 m, as in the published package.
    """
    if format not in _TOES:
        raise UsageError(f"unknown format {format!r}: expected {' or '.join(map(repr, _TOES))}; "
                         + _ANY)
    clip = retarget.load(bvh_file)
    names = list(clip.joint_names)
    index = {name: i for i, name in enumerate(names)}
    toes = _TOES[format]
    wanted = [side + part for side in ("Left", "Right") for part in ("Foot", toes)]
    missing = [name for name in wanted if name not in index]
    if missing:
        raise InputError(f"{os.fsdecode(bvh_file)}: no joint {', '.join(missing)}, so "
                         f"this is not a skeleton of format {format!r}; {_ANY}")
    positions = _z_up(clip.positions)
    rotations = _turned_z_up(clip.rotations_wxyz)
    sources = [(i, i) for i in range(len(names))]
    for side in ("Left", "Right"):
        names.append(side + "FootMod")
        sources.append((index[side + "Foot"], index[side + toes]))
    return frames_of(names, positions, rotations, sources), _HEIGHT


def load_lafan1_file(bvh_file: str | os.PathLike[str]) -> tuple[list[Frame], float]:
    """The same for LAFAN1, under its older name."""
    return load_bvh_file(bvh_file, "lafan1")
