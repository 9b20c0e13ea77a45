"""Exceptions and warnings of the package."""

from __future__ import annotations

import errno
import os
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


def checked_number(value: Any, name: str) -> float:
    """Returns the value of an argument as a float."""
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentTypeError(f"{name}: expected a number, found {value!r:.60}") from None


class InputError(Error, ValueError):
    """A motion is invalid: malformed, without frames, or lacking a bone."""

    kind = "input"


class ConfigError(Error, ValueError):
    """A configuration, profile, model or robot name is invalid."""

    kind = "config"


class _MissingFile(FileNotFoundError):
    """The attributes of an OSError, for errors about missing files."""

    # OSError would print its number and the file name instead of the text.
    __str__ = Exception.__str__

    def _describe_file(self, file: str) -> None:
        self.errno = errno.ENOENT
        self.strerror = os.strerror(errno.ENOENT)
        self.filename = file


class MissingInputError(InputError, _MissingFile):
    """The motion file or scene does not exist."""

    def __init__(self, text: str, message: str = "", file: str = "", *more: Any) -> None:
        super().__init__(text, message, file, *more)
        self._describe_file(file)


class MissingConfigError(ConfigError, _MissingFile):
    """The configuration, profile or model does not exist."""

    def __init__(self, text: str, message: str = "", file: str = "", *more: Any) -> None:
        super().__init__(text, message, file, *more)
        self._describe_file(file)


class RunError(Error, RuntimeError):
    """An operation failed: an output could not be written, or clips do not match at a seam."""

    kind = "run"


class RetargetWarning(UserWarning):
    """A problem that did not stop the work: an uncertain assumption, a damaged file."""


_KINDS: dict[str, type[Error]] = {kind.kind: kind
                                  for kind in (UsageError, InputError, ConfigError, RunError)}

_MISSING: dict[type[Error], type[Error]] = {InputError: MissingInputError,
                                            ConfigError: MissingConfigError}


def make_error(kind: str, text: str, message: str, file: str, line: int, column: int,
               details: list[str], hint: str) -> BaseException:
    """Raises an error of the library; called by the module."""
    if kind == "interrupted":
        return KeyboardInterrupt(text)
    if kind == "type":
        return ArgumentTypeError(text)
    chosen = _KINDS[kind]
    # The library's message has the system's text and the file name that the user gave.
    if os.strerror(errno.ENOENT) in message and file and not os.path.exists(file):
        chosen = _MISSING.get(chosen, chosen)
    return chosen(text, message, file, line, column, tuple(details), hint)


def warn(text: str) -> None:
    """Issues a warning of the library at the user's line; called by the module."""
    level = 1
    frame = sys._getframe()
    while frame.f_back is not None and _is_ours(frame.f_globals.get("__name__", "")):
        frame = frame.f_back
        level += 1
    warnings.warn(text, RetargetWarning, stacklevel=level)


def _is_ours(module: str) -> bool:
    return module == "retarget" or module.startswith("retarget.")
