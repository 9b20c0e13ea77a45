"""Streams over the network and in files, as in the command `retarget live` (docs/live.md)."""

from __future__ import annotations

import atexit
import os
import threading
import time as clock
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from retarget import _retarget
from retarget._api import StrPath, _clip, _taken
from retarget._errors import UsageError
from retarget._signatures import names_of, with_options

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from retarget import _options

_LISTENING = "input: listening at "


class Server:
    """A live run in its own thread, created by serve(). The end of the `with` block stops it."""

    def __init__(self, engine: _retarget.Server, query: str) -> None:
        self._engine = engine
        self._query = query
        self._error: BaseException | None = None
        self._summary: dict[str, Any] | None = None
        self._thread = threading.Thread(target=self._run, name="retarget.serve", daemon=True)
        self._thread.start()
        # A daemon thread would otherwise run while the interpreter shuts down.
        atexit.register(self._end)

    def wait(self, timeout: float | None = None) -> dict[str, Any] | None:
        """Waits until the run is over: after `seconds`, at the end of its input, or stopped.

        Args:
            timeout: seconds; None: no limit.

        Returns:
            The summary; None if the run is not over yet.

        Raises:
            RunError: an output or a recording is incomplete.
            InputError, ConfigError: the input cannot be used, or has no human.
        """
        self._thread.join(timeout)
        if self._thread.is_alive():
            return None
        atexit.unregister(self._end)
        if self._error is not None:
            raise self._error
        return self._summary

    def stop(self) -> dict[str, Any]:
        """Stops the run and returns its summary. A second call returns the same.

        Raises:
            RunError, InputError, ConfigError: as wait().
        """
        self._engine.stop()
        summary = self.wait()
        assert summary is not None
        return summary

    def recalibrate(self) -> None:
        """Calibrates the body from the performer's next pose, with `calibrate="tpose"` or "npose"."""
        self._engine.recalibrate()

    @property
    def running(self) -> bool:
        """Whether the run is active."""
        return self._thread.is_alive()

    @property
    def address(self) -> str:
        """Listening address, for play(); empty: not listening yet, or not on a network."""
        return next((line.removeprefix(_LISTENING) + self._query for line in self.messages
                     if line.startswith(_LISTENING)), "")

    @property
    def messages(self) -> list[str]:
        """Lines that the command prints: addresses, the content of the stream, faults."""
        return self._engine.messages()

    @property
    def summary(self) -> dict[str, Any]:
        """Counters of frames and packets, latencies and outputs; empty while it runs."""
        return {} if self._summary is None else self._summary

    def __enter__(self) -> Server:
        return self

    def __exit__(self, *exception: object) -> None:
        if exception[0] is None:
            self.stop()
        else:
            self._end()

    def __repr__(self) -> str:
        return f"<retarget.Server: {'running' if self.running else 'over'}>"

    def _run(self) -> None:
        try:
            self._summary = self._engine.run()
        except BaseException as error:  # Raised again in the caller's thread.
            self._error = error

    def _end(self) -> None:
        self._engine.stop()
        self._thread.join()
        atexit.unregister(self._end)


@with_options("ServeOptions")
def serve(robot: StrPath | None = None, *, input: str | None = None,
          output: StrPath | Sequence[StrPath] | None = None, fps: float | None = None,
          data_dir: StrPath | None = None, **options: Unpack[_options.ServeOptions]) -> Server:
    """Retargets a stream from the network to robot frames, until the `with` block ends.

        with retarget.serve("unitree_g1", input="udp:1118?format=bvh",
                            output=["udp:5005", "frames.csv"], record="take_1/") as server:
            server.wait(60)
        server.summary["robot_frames"]

    The call returns when the run is listening; the run has its own thread. If your program has the
    human frames, use live().

    Args:
        robot: name or folder of the robot; not needed with `replay`.
        input: address of the stream; not needed with `replay`.
        output: one or several addresses or files.
        fps: robot frames per second; None: 50, or those of `replay`.
        data_dir: folder with robots/ and configs/.

    Raises:
        UsageError: no input or no output; options that contradict each other.
        RunError: an unavailable address.
        ConfigError: an unknown robot.
    """
    if input is None and not options.get("replay"):
        raise UsageError('input: expected an address, such as "udp:1118?format=bvh"')
    if not output:
        raise UsageError('output: expected an address or a file, such as "udp:5005" or "out.csv"')
    outputs = [output] if isinstance(output, (str, os.PathLike)) else output
    given: dict[str, Any] = {"input": input, "output": [os.fsdecode(each) for each in outputs],
                             **options}
    query = "".join((input or "").partition("?")[1:])
    server = Server(_retarget.Server(robot, fps, given, data_dir), query)
    while server.running and not server.address and input not in (None, "stdin"):
        clock.sleep(0.002)
    if not server.running:
        server.wait()
    return server


@with_options("PlayerOptions", "SourceOptions")
def play(clip: _retarget.Clip | StrPath, to: str, *, speed: float = 1.0, header: bool = True,
         data_dir: StrPath | None = None, **options: Unpack[_options.PlayOptions]) -> int:
    """Sends a human motion like a motion capture system, for example to serve().

        retarget.play("walk.bvh", "udp:1118?format=bvh")

    It returns at the end of the clip; Ctrl-C stops it.

    Args:
        clip: a clip, or the path of a file (options of load() are then allowed).
        to: address of the receiver.
        speed: speed factor; 0: as fast as possible.
        header: send the skeleton first, in formats that have one.
        data_dir: folder with robots/ and configs/.

    Returns:
        The number of sent frames.

    Raises:
        UsageError: a malformed address.
        RunError: an unavailable address.
        InputError: no human in the clip, in formats with fixed bones.
    """
    given: dict[str, Any] = dict(options)
    of_source = _taken(given, names_of("SourceOptions") - names_of("PlayerOptions"))
    return _retarget.play(_clip(clip, of_source, data_dir), to, float(speed), header, given,
                          data_dir)
