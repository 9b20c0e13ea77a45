"""Files of robot motions, and the robots: convert, compare, robots."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from retarget import _retarget
from retarget._api import StrPath, _check_loaded, load_motion
from retarget._errors import UsageError
from retarget._signatures import names_of, with_options

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from retarget import _options


@with_options("ConvertOptions")
def convert(input: StrPath, output: StrPath, robot: _retarget.Robot | StrPath | None = None, *,
            data_dir: StrPath | None = None,
            **options: Unpack[_options.ConvertOptions]) -> list[Path]:
    """Converts a robot motion to another format or rate, with the same bytes as `retarget convert`.

    Without a robot, a human motion is written as GLB.

    Args:
        input: a robot motion in any format of docs/formats.md; for GLB also a human motion.
        output: the ending or `format` determines the format.
        robot: a robot, or its name or folder; None: `robot_xml`.
        data_dir: folder with robots/ and configs/.

    Returns:
        The written files, one per format.

    Raises:
        UsageError: options that contradict each other, an output that is also an input.
        InputError: a malformed or ambiguous file; FileNotFoundError as well if it is missing.
        ConfigError: an unknown robot.
        RunError: the output cannot be written.
    """
    _check_loaded(robot, data_dir, options)
    written = _retarget.convert(input, output, robot, dict(options), data_dir)
    return [Path(path) for path in written]


@dataclass(frozen=True)
class ColumnDifference:
    """A column that differs by more than the tolerance, in the unit of the column."""

    column: str
    largest: float
    """Infinite if a number is NaN."""
    largest_frame: int
    first_frame: int
    """The first frame beyond the tolerance."""
    frames_beyond: int


@dataclass(frozen=True)
class Comparison:
    """Differences of two motions; true if they agree. `str()` is what the command prints."""

    agree: bool
    largest: float
    frames: tuple[int, int]
    columns: list[ColumnDifference]
    """Columns beyond the tolerance, the worst first."""
    lines: list[str]

    def __bool__(self) -> bool:
        return self.agree

    def __str__(self) -> str:
        return "\n".join(self.lines)


@with_options("ReadingOptions", "RobotOptions")
def compare(a: _retarget.Motion | StrPath, b: _retarget.Motion | StrPath,
            robot: _retarget.Robot | StrPath | None = None, *, tolerance: float = 1e-6,
            data_dir: StrPath | None = None,
            **options: Unpack[_options.LoadMotionOptions]) -> Comparison:
    """Compares two motions column by column, like `retarget compare`; q and -q are equal.

    Args:
        a, b: motions, or files. Two files without a robot are compared as tables of numbers. A file
            beside a motion is read for the robot of the motion.
        robot: the robot of the files; the options of load_motion() are then allowed.
        tolerance: largest accepted difference, in the unit of a column (metres, radians).
        data_dir: folder with robots/ and configs/.

    Raises:
        InputError: the motions have different columns; a malformed file.
    """
    motions = [each for each in (a, b) if isinstance(each, _retarget.Motion)]
    if robot is None and motions:
        robot = motions[0].robot
    has_robot = robot is not None or options.get("robot_xml") is not None
    given = sorted(name for name, value in options.items() if value is not None)
    if given and not has_robot and names_of("ReadingOptions") | names_of("RobotOptions") >= {
            *given}:
        raise UsageError(f"{given[0]} needs a robot; without one, files are compared as they are")
    if has_robot or options:
        a, b = (each if isinstance(each, _retarget.Motion) else
                load_motion(each, robot, data_dir=data_dir, **options) for each in (a, b))
    agree, largest, frames_a, frames_b, columns, lines = _retarget.compare(a, b, float(tolerance))
    return Comparison(agree, largest, (frames_a, frames_b),
                      [ColumnDifference(*column) for column in columns], list(lines))


@dataclass(frozen=True)
class RobotFacts:
    """Facts about a robot that is not loaded."""

    name: str
    description: str
    installed: bool
    joints: int | None
    """Number of output columns; None: not installed, or it cannot be loaded."""
    height: float | None
    """Metres, from the soles to the highest point; None: unknown."""
    has_configuration: bool
    """Whether there is a retargeting configuration from humans."""
    licence: str
    licence_stated: bool
    """Whether the maker states a licence for the model."""
    revision: str | None = None
    """Revision of the source; None: not recorded, or not installed."""
    revision_date: str | None = None
    """Date of the revision, YYYY-MM-DD; None: as `revision`."""
    error: str | None = None
    """Why an installed robot cannot be loaded; None: it can, or it is not installed."""


def robots(*, data_dir: StrPath | None = None) -> list[RobotFacts]:
    """Lists all robots, sorted by name: the installed ones, and known ones that are not installed.

    Args:
        data_dir: folder with robots/ and configs/.

    Raises:
        ConfigError: no data folder, or an invalid list of known robots in it.
    """
    return [RobotFacts(name=each["name"], description=each.get("description", ""),
                       installed=each.get("installed", True), joints=each.get("joints"),
                       height=each.get("height_m"), has_configuration=each.get("mapping", False),
                       licence=each.get("licence", ""),
                       licence_stated=each.get("licence_stated", False),
                       revision=each.get("revision"), revision_date=each.get("revision_date"),
                       error=each.get("error"))
            for each in json.loads(_retarget.robots_json(data_dir))]


def robot_facts(robot: str | os.PathLike[str], *, data_dir: StrPath | None = None) -> dict[str, Any]:
    """Everything that `retarget robots show --json` prints: joints, limits, heights, soles.

    Args:
        robot: name or folder.
        data_dir: folder with robots/ and configs/.

    Raises:
        ConfigError: an unknown robot, or errors in its files.
    """
    return json.loads(_retarget.robot_json(robot, data_dir))
