"""Exceptions and warnings of the package."""

from __future__ import annotations

import sys
import warnings
from typing import Any


class Error(Exception):
    """Base class of all retarget exceptions. `str(error)` is the text that the command prints.

    Attributes:
        kind: `usage`, `input`, `config` or `run`.
        message: expected and found values, one sentence.
        file: the affected file as given; may be empty.
        line, column: 1-based position in the file, the column in bytes; 0: unknown.
        details: several faults, one sentence each.
        hint: suggested remedy; may be empty.
    """

    kind: str = "run"

    def __init__(self, text: str, message: str = "", file: str = "", line: int = 0,
                 column: int = 0, details: tuple[str, ...] = (), hint: str = "") -> None:
        super().__init__(text)
        self.message = message or text
        self.file = file
        self.line = line
        self.column = column
        self.details = tuple(details)
        self.hint = hint

    def __reduce__(self) -> tuple[Any, ...]:
        # Keeps all attributes when pickled, for queues and process pools.
        return type(self), (str(self), self.message, self.file, self.line, self.column,
                            self.details, self.hint)


class UsageError(Error, ValueError):
    """The call is wrong: unknown or contradictory options, arrays of a wrong shape."""

    kind = "usage"


class ArgumentTypeError(UsageError, TypeError):
    """An argument has the wrong type."""


class InputError(Error, ValueError):
    """A motion is invalid: malformed, without frames, or lacking a bone."""

    kind = "input"


class ConfigError(Error, ValueError):
    """A configuration, profile, model or robot name is invalid."""

    kind = "config"


class RunError(Error, RuntimeError):
    """An operation failed: an output could not be written, or clips do not fit at a seam."""

    kind = "run"


class RetargetWarning(UserWarning):
    """A problem that did not stop the work: an uncertain assumption, a damaged file."""


_KINDS: dict[str, type[Error]] = {kind.kind: kind
                                  for kind in (UsageError, InputError, ConfigError, RunError)}


def make_error(kind: str, text: str, message: str, file: str, line: int, column: int,
               details: list[str], hint: str) -> BaseException:
    """Called by the module for an error of the library."""
    if kind == "interrupted":
        return KeyboardInterrupt(text)
    if kind == "type":
        return ArgumentTypeError(text)
    return _KINDS[kind](text, message, file, line, column, tuple(details), hint)


def warn(text: str) -> None:
    """Called by the module for a warning of the library; names the user's line."""
    level = 1
    frame = sys._getframe()
    while frame.f_back is not None and _is_ours(frame.f_globals.get("__name__", "")):
        frame = frame.f_back
        level += 1
    warnings.warn(text, RetargetWarning, stacklevel=level)


def _is_ours(module: str) -> bool:
    return module == "retarget" or module.startswith("retarget.")
