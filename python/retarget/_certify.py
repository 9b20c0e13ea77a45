"""Certificates: figures, simulation and prediction of a motion file in one document."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from retarget import _retarget
from retarget._api import StrPath
from retarget._signatures import with_options

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from retarget import _options


class Certificate(Mapping[str, Any]):
    """A certificate as a mapping; docs/certificate.md has its members."""

    def __init__(self, json_text: str, motion: StrPath) -> None:
        self.json = json_text
        """The certificate as `retarget certify` writes it."""
        self.motion = Path(os.fsdecode(motion))
        """The motion file that it is about."""

    @cached_property
    def data(self) -> dict[str, Any]:
        """The certificate, as in its JSON."""
        return json.loads(self.json)

    def __getitem__(self, key: str) -> Any:
        return self.data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self.data)

    def __len__(self) -> int:
        return len(self.data)

    @property
    def passed(self) -> bool:
        """Whether the gates passed and the simulated robot did not fall."""
        return self.data["verdict"]["passed"]

    @property
    def fell(self) -> bool:
        """Whether the simulated robot fell."""
        return self.data["simulation"]["fell"]

    @property
    def predicted_tracking_success(self) -> float | None:
        """Predicted probability of being tracked without a fall; None if it is unknown."""
        return self.data["prediction"]["predicted_tracking_success"]

    def save(self, file: StrPath | None = None) -> Path:
        """Writes the certificate, by default next to its motion: `MOTION.certificate.json`.

        verify() finds the motion next to the certificate.
        """
        path = (Path(os.fsdecode(file)) if file is not None else
                self.motion.with_name(self.motion.name + ".certificate.json"))
        unfinished = path.with_name(path.name + ".unfinished")
        try:
            unfinished.write_text(self.json, encoding="utf-8")
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)
        return path

    def __repr__(self) -> str:
        verdict = "passed" if self.passed else "fell" if self.fell else "missed a gate"
        return f"<retarget.Certificate: {self.motion.name}, {verdict}>"


@with_options("CertifyOptions")
def certify(motion: StrPath, robot: StrPath | None = None, clip: StrPath | None = None, *,
            mirror: bool = False, data_dir: StrPath | None = None,
            **options: Unpack[_options.CertifyOptions]) -> Certificate:
    """Measures, simulates and predicts a motion file, like `retarget certify`.

    Args:
        motion: file of a robot motion; Motion.save() writes one.
        robot: name or folder of the robot; None: `robot_xml`.
        clip: file of its source, to which the motion is compared; None: figures that need a source
            are left out.
        mirror: the motion is that of the mirror image of the source.
        data_dir: folder with robots/ and configs/.

    Returns:
        The certificate, which is not written: see Certificate.save(). verify() checks it.

    Raises:
        InputError: a malformed file, fewer than three frames.
        ConfigError: an unknown robot; a robot with a fixed base, without soles or without masses.
    """
    return Certificate(_retarget.certify(motion, robot, clip, mirror, dict(options), data_dir),
                       motion)
