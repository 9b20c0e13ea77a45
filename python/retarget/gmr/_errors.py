"""Name errors, which are also KeyErrors, as in the published package."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping

from retarget._errors import InputError, UsageError


class MissingBodyError(InputError, KeyError):
    """A human frame lacks bodies of the tables."""

    __str__ = Exception.__str__


class UnknownNameError(UsageError, KeyError):
    """The robot is unknown, or has no tables for the human."""

    __str__ = Exception.__str__


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f'"{name}"' for name in names)


def missing_bodies(missing: list[str], config: str, human_data: Mapping[str, object]) -> Exception:
    """Called by the module: the error of a frame without these bodies."""
    bodies = "the body" if len(missing) == 1 else "the bodies"
    there = [str(name) for name in human_data]
    more = ", ..." if len(there) > 12 else ""
    has = f"it has {_listed(there[:12])}{more}" if there else "it is empty"
    return MissingBodyError(f"human_data lacks {bodies} {_listed(missing)} of {config}; {has}")


def unknown_name(what: str, name: object, known: Iterable[str], hint: str = "") -> UnknownNameError:
    """Returns the error for a name that is not among the known ones."""
    names = [str(each) for each in known]
    near = difflib.get_close_matches(str(name), names, n=1)
    meant = f", did you mean {near[0]!r}?" if near else f": there are {_listed(names)}"
    text = f"unknown {what} {name!r}{meant}"
    return UnknownNameError(f"{text}; {hint}" if hint else text)
