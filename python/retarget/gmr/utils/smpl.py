"""SMPL-X motions in the format of the published class, read without torch and smplx."""

from __future__ import annotations

import os
import pathlib
from collections.abc import Mapping
from typing import Any

import numpy as np

import retarget
from retarget._errors import InputError, UsageError
from retarget.gmr._frames import Frame, frames_of

# The published package interpolates linearly if the cosine of half the angle between two rotations
# exceeds this value.
_NEARLY_EQUAL = 0.9995


def _text(value: np.ndarray | None) -> str:
    if value is None or value.size == 0:
        return ""
    first = value.ravel()[0]
    return first.decode("utf-8", "replace") if isinstance(first, bytes) else str(first)


def _model_in(folder: pathlib.Path, gender: str) -> pathlib.Path:
    name = f"SMPLX_{(gender or 'neutral').upper()}"
    for place in (folder / "smplx", folder):
        if (place / f"{name}.npz").is_file():
            return place / f"{name}.npz"
    pickled = [place for place in (folder / "smplx", folder) if (place / f"{name}.pkl").is_file()]
    hint = (f"there is {pickled[0] / name}.pkl: docs/smpl.md shows how to make an NPZ of it"
            if pickled else "without a model (None), the bone lengths of a generic adult are used")
    raise InputError(f"{folder}: there is no {name}.npz; {hint}")


def load_smplx_file(smplx_file: str | os.PathLike[str],
                    smplx_body_model_path: str | os.PathLike[str] | None = None,
                    ) -> tuple[dict[str, np.ndarray], str | None, retarget.Clip, float]:
    """Reads an NPZ of SMPL-X as in AMASS; the 22 joints of the body, no hands, no face.

    Args:
        smplx_file: the motion.
        smplx_body_model_path: your model as NPZ, or the folder with smplx/SMPLX_NEUTRAL.npz; None:
            the bone lengths of a generic adult.

    Returns:
        (smplx_data, body_model, smplx_output, human_height): the arrays of the file; the model's
        file; the motion as a retarget.Clip, metres, Z up; 1.66 m + 0.1 m times the first shape
        parameter. Pass the first three on to get_smplx_data_offline_fast.
    """
    arrays: dict[str, np.ndarray] = {}
    path = os.fsdecode(smplx_file)
    try:
        opened = np.load(path, allow_pickle=False)
        if not isinstance(opened, np.lib.npyio.NpzFile):
            raise ValueError("it holds one array")
        with opened as file:
            for name in file.files:
                try:
                    arrays[name] = file[name]
                except ValueError:  # Python objects, such as a gender, are not needed.
                    continue
    except Exception as error:  # zipfile, zlib and array headers raise many kinds
        raise InputError(f"{path}: not an NPZ of SMPL-X: {error}") from None
    model: str | None = None
    if smplx_body_model_path is not None:
        given = pathlib.Path(smplx_body_model_path)
        model = str(_model_in(given, _text(arrays.get("gender"))) if given.is_dir() else given)
    clip = retarget.load(path, smpl_model=model)
    betas = np.asarray(arrays.get("betas", ()), dtype=float).ravel()
    height = 1.66 + 0.1 * (float(betas[0]) if betas.size else 0.0)
    return arrays, model, clip, height


def _clip_of(smplx_output: Any) -> retarget.Clip:
    if isinstance(smplx_output, retarget.Clip):
        return smplx_output
    raise UsageError("smplx_output: expected what retarget.gmr's load_smplx_file gave, found "
                     f"{type(smplx_output).__name__}")


def get_smplx_data(smplx_data: Mapping[str, np.ndarray], body_model: str | None,
                   smplx_output: retarget.Clip, curr_frame: int) -> Frame:
    """Returns one frame of a motion of load_smplx_file: {joint: [position (3,), quaternion (4,) w x y z]}."""
    clip = _clip_of(smplx_output)
    frame = range(len(clip))[curr_frame]
    return frames_of(clip.joint_names, clip.positions[frame:frame + 1],
                     clip.rotations_wxyz[frame:frame + 1])[0]


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Product of quaternions (..., 4), w x y z."""
    w, v = a[..., :1], a[..., 1:]
    x, u = b[..., :1], b[..., 1:]
    return np.concatenate([w * x - np.sum(v * u, axis=-1, keepdims=True),
                           w * u + x * v + np.cross(v, u)], axis=-1)


def _between(a: np.ndarray, b: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Rotations between a and b (..., 4), the shorter way; share broadcasts over the last axis."""
    cosine = np.sum(a * b, axis=-1, keepdims=True)
    b = np.where(cosine < 0.0, -b, b)
    cosine = np.minimum(np.abs(cosine), 1.0)
    angle = np.arccos(np.minimum(cosine, _NEARLY_EQUAL))
    on_arc = (np.sin((1.0 - share) * angle) * a + np.sin(share * angle) * b) / np.sin(angle)
    mixed = np.where(cosine > _NEARLY_EQUAL, (1.0 - share) * a + share * b, on_arc)
    unit: np.ndarray = mixed / np.linalg.norm(mixed, axis=-1, keepdims=True)
    return unit


def get_smplx_data_offline_fast(smplx_data: Mapping[str, np.ndarray], body_model: str | None,
                                smplx_output: retarget.Clip, tgt_fps: float = 30,
                                is_smplh: bool = False) -> tuple[list[Frame], float]:
    """Returns the frames of a clip of load_smplx_file, at most at the given rate.

    Every int(fps / tgt_fps) frames become one, interpolated at even distances from the first to the
    last. A file with fewer frames per second than tgt_fps keeps its rate.

    Returns:
        (frames, fps): for every frame {joint: [position (3,), quaternion (4,)]}, world, metres, Z
        up, quaternions w x y z; their rate.
    """
    clip = _clip_of(smplx_output)
    if is_smplh:
        raise UsageError("is_smplh: hands are not read, the frames have the 22 joints of the body")
    if not tgt_fps > 0:
        raise UsageError(f"tgt_fps: expected more than 0 frames per second, found {tgt_fps}")
    positions, rotations = clip.positions, clip.rotations_wxyz
    fps = float(clip.fps)
    if tgt_fps < fps:
        count = len(clip) // int(fps / tgt_fps)
        times = np.linspace(0, len(clip) - 1, count)
        before = np.floor(times).astype(int)
        after = np.minimum(before + 1, len(clip) - 1)
        share = (times - before)[:, None, None]
        positions = (1.0 - share) * positions[before] + share * positions[after]
        local = clip.local_rotations_wxyz
        rotations = _between(local[before], local[after], share)
        for joint, parent in enumerate(clip.parents):
            if parent >= 0:
                rotations[:, joint] = _product(rotations[:, parent], rotations[:, joint])
        fps = count / len(clip) * fps
    return frames_of(clip.joint_names, positions, rotations), fps
