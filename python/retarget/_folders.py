"""Functions of whole commands other than batch(): verify, gallery, add_robot."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from retarget import _retarget
from retarget._api import StrPath
from retarget._signatures import with_options

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from retarget import _options


def verify(sidecar: StrPath, *, data_dir: StrPath | None = None) -> list[str]:
    """Repeats a recorded run without writing, and checks that its bytes and report are the recorded ones.

    Args:
        sidecar: FILE.json, which `retarget` and batch() write with `sidecar`; or a certificate of
            certify(), whose figures are computed again.
        data_dir: folder with robots/ and configs/.

    Returns:
        The lines of `retarget verify`: inputs that have changed since, and the agreement.

    Raises:
        RunError: the output or its report differs, or its file has changed; a figure of the certificate differs.
        InputError: neither a sidecar nor a certificate, or a motion that cannot be read again.
    """
    return _retarget.verify(sidecar, data_dir)


@with_options("GalleryOptions")
def gallery(batch: StrPath, output: StrPath, robot: StrPath | None = None, *,
            data_dir: StrPath | None = None, **options: Unpack[_options.GalleryOptions]) -> Path:
    """Makes a page for each motion of a batch, and an index page with pictures and gates.

    Args:
        batch: output folder of batch(), which may still be running.
        output: folder of the pages; a gallery in it is replaced.
        robot: name or folder of a robot of the batch, loaded instead of its recorded name.
        data_dir: folder with robots/ and configs/.

    Returns:
        The index page.

    Raises:
        InputError: a folder without a manifest.
        UsageError: an output that is a folder of the batch, a robot that is not in it.
    """
    _retarget.gallery(batch, output, robot, dict(options), data_dir)
    return Path(os.fsdecode(output)) / "index.html"


@dataclass(frozen=True)
class AddedRobot:
    """Result of add_robot()."""

    folder: Path
    """The robot's folder; `Robot(folder)` loads it. decisions.md in it documents the decisions."""
    summary: list[str]
    """Detected limbs, T-pose and scales, one line each."""
    notes: list[str]
    """Items that a user should check, one line each."""


def add_robot(model: StrPath, name: str, output: StrPath = ".", *,
              base: Literal["auto", "fixed"] | None = None,
              force: bool = False) -> AddedRobot:
    """Makes a robot's folder from its model (docs/own_robot.md).

    Args:
        model: MJCF or URDF; meshes are not needed.
        name: name of the new robot.
        output: the folder in which the robot's folder is made.
        base: `fixed`: an upper body on a stand or a wheeled platform; it needs no legs.
        force: replace the folder of an earlier call.

    Raises:
        UsageError: an invalid name, a folder that exists.
        ConfigError: a model that is not a humanoid, or that cannot be used.
    """
    folder, summary, notes = _retarget.add_robot(model, name, output, {"base": base}, force)
    return AddedRobot(Path(folder), summary, notes)
