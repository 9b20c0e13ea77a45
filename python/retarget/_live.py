"""Live retargeting: human frames in, robot frames out (docs/live.md)."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from retarget import _retarget
from retarget._api import StrPath, _clip, _robot, _taken
from retarget._errors import ArgumentTypeError, RunError, UsageError, checked_number
from retarget._signatures import names_of, with_options

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from retarget import _options

# Robot frames that have been due for longer are dropped and counted as `missed`, seconds. On the
# session's own clock they would reach the robot in a burst. On the caller's clock a recording may
# have gaps, but a wrong time must not give frames without end.
_LONGEST_PAUSE = 1.0
_LONGEST_GAP = 10.0


def _seconds(value: float, name: str) -> float:
    seconds = checked_number(value, name)
    if not abs(seconds) <= _retarget.MAX_LIVE_TIME:
        raise UsageError(f"{name}: expected a finite number of seconds, at most "
                         f"{_retarget.MAX_LIVE_TIME:g}, found {value}")
    return seconds


@dataclass(frozen=True, eq=False)
class RobotFrame:
    """A configuration of the robot at a time."""

    index: int
    """Index of the robot frame, from 0."""
    time: float
    """Time of its human pose, seconds. It starts on the sender's clock and continues evenly if
    that clock jumps."""
    state: str
    """`following`, `holding` (frames are missing) or `standing` (they are missing for long)."""
    qpos: np.ndarray
    """(7 + n,) float64: like a row of Motion.qpos; metres, radians, quaternion w x y z."""
    due: float
    """Time at which the frame is due, seconds on the caller's clock (`now`)."""


class LiveSession:
    """A live session, created by live(). Use it in a `with` block, from one thread at a time."""

    def __init__(self, engine: _retarget.LiveSession, source: Iterable[Any] | None,
                 callback: Callable[[RobotFrame], object] | None) -> None:
        self._engine = engine
        self._source = iter(source) if source is not None else None
        self._callback = callback
        self._closed = False
        self._start = clock.monotonic()

    def push(self, rotations_wxyz: ArrayLike, positions: ArrayLike, *, time: float | None = None,
             now: float | None = None) -> list[RobotFrame]:
        """Adds a human frame, and returns the robot frames that are due.

        Args:
            rotations_wxyz: (J, 4) unit quaternions parent_from_joint, like a frame of
                Clip.local_rotations_wxyz of the calibrating clip.
            positions: (J, 3) positions in the parents' frames, like a frame of
                Clip.local_positions; ignored for joints with a fixed offset.
            time: seconds on the sender's clock; None: the time of arrival.
            now: seconds on a clock of the caller, which must not decrease; None: the time since the
                session began. Give it to replay a recording faster than it was made. After a
                jump by more than ten seconds (on the session's own clock, after a pause of more than
                a second), the robot frames in between are dropped and counted as `missed`.

        Raises:
            UsageError: another shape, quaternions that are not of unit length, times that are not
                finite.
            RunError: the session has ended.
        """
        if self._closed:
            raise RunError("the live session has ended")
        stamp = math.nan if time is None else _seconds(time, "time")
        moment = self._now(now)
        self._engine.push(rotations_wxyz, positions, stamp, moment)
        return self._due(moment, now)

    def pull(self, *, now: float | None = None) -> list[RobotFrame]:
        """Returns the robot frames that are due, even if no human frame arrived.

        Args:
            now: as for push().

        Raises:
            UsageError: a time that is not finite.
        """
        return self._due(self._now(now), now)

    def close(self) -> list[RobotFrame]:
        """Ends the stream and returns the remaining robot frames. A second call returns none."""
        if self._closed:
            return []
        self._closed = True
        self._engine.finish()
        return self._due(self._now(None), None)

    @property
    def due(self) -> float | None:
        """Due time of the next robot frame, seconds on the caller's clock; None: no human yet."""
        return self._engine.due()

    @property
    def state(self) -> str:
        """`waiting`, `following`, `holding` or `standing`."""
        return self._engine.state()

    @property
    def statistics(self) -> dict[str, Any]:
        """Counters of frames: received, lost, late, robot_frames, held, limited, ..."""
        return self._engine.statistics()

    @property
    def robot(self) -> _retarget.Robot:
        """The robot."""
        return self._engine.robot()

    def __iter__(self) -> Iterator[RobotFrame]:
        """Reads human frames from `source` and yields robot frames. The session ends with `source`.

        A human frame is (rotations_wxyz, positions) or (rotations_wxyz, positions, time). With a
        time, it also is the caller's clock: a recording plays as fast as it is read.

        Raises:
            UsageError: the source is missing, or one of its frames has another form.
        """
        if self._source is None:
            raise UsageError("the session has no source: give live(source=...), or call push()")
        for frame in self._source:
            if not isinstance(frame, tuple) or len(frame) not in (2, 3):
                raise UsageError("source: expected (rotations_wxyz, positions) or "
                                 "(rotations_wxyz, positions, time)")
            time = frame[2] if len(frame) == 3 else None
            yield from self.push(frame[0], frame[1], time=time, now=time)
        yield from self.close()

    def __enter__(self) -> LiveSession:
        return self

    def __exit__(self, *exception: object) -> None:
        if exception[0] is None:
            self.close()
        self._closed = True

    def _now(self, now: float | None) -> float:
        return clock.monotonic() - self._start if now is None else _seconds(now, "now")

    def _due(self, moment: float, given: float | None) -> list[RobotFrame]:
        longest = _LONGEST_PAUSE if given is None else _LONGEST_GAP
        frames = [RobotFrame(*frame) for frame in self._engine.pull(moment, longest)]
        if self._callback is not None:
            for frame in frames:
                self._callback(frame)
        return frames


@with_options("LiveOptions", "RobotOptions", "SourceOptions")
def live(clip: _retarget.Clip | StrPath, robot: _retarget.Robot | StrPath | None = None, *,
         source: Iterable[Any] | None = None,
         callback: Callable[[RobotFrame], object] | None = None, fps: float = 50.0,
         data_dir: StrPath | None = None,
         **options: Unpack[_options.LiveRobotOptions]) -> LiveSession:
    """Opens a live session, which returns robot frames at a constant rate.

        with retarget.live("walk.bvh", "unitree_g1", callback=send) as session:
            for rotations, positions in tracker:
                session.push(rotations, positions)

    Args:
        clip: a recording of the performer, such as a T-pose: it gives the skeleton and calibrates
            the body. A path is allowed, with options of load().
        robot: a robot, or an argument of Robot() (its options are then allowed).
        source: human frames for `for frame in session`; see LiveSession.__iter__.
        callback: called with every RobotFrame, in the calling thread.
        fps: robot frames per second, 1 to 1000, independent of the rate of the human frames.
        data_dir: folder with robots/ and configs/.

    Raises:
        UsageError: options that contradict each other.
        InputError: no human in the clip.
        ConfigError: an unknown robot.
    """
    if callback is not None and not callable(callback):
        raise ArgumentTypeError(f"callback: expected a function, found {type(callback).__name__}")
    given: dict[str, Any] = dict(options)
    of_source = _taken(given, names_of("SourceOptions") - names_of("LiveOptions"))
    of_robot = _taken(given, names_of("RobotOptions") - names_of("LiveOptions"))
    loaded = _clip(clip, of_source, data_dir)
    engine = _retarget.LiveSession(loaded, _robot(robot, data_dir, of_robot), fps, given)
    return LiveSession(engine, source, callback)
