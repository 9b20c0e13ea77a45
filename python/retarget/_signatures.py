"""Signatures and docs of functions whose options are rows of the engine's tables."""

from __future__ import annotations

import functools
import inspect
import textwrap
from collections.abc import Callable
from typing import Any, TypeVar

from retarget import _retarget

Function = TypeVar("Function", bound=Callable[..., Any])


@functools.lru_cache(maxsize=None)
def _tables() -> dict[str, list[dict[str, Any]]]:
    return _retarget.option_tables()


@functools.lru_cache(maxsize=None)
def names_of(table: str) -> frozenset[str]:
    """The keywords of a table."""
    return frozenset(row["name"] for row in _tables()[table])


def rows_of(*tables: str) -> list[dict[str, Any]]:
    """The rows of tables, each option once."""
    rows = {row["name"]: row for table in tables for row in _tables()[table]}
    return list(rows.values())


def with_options(*tables: str) -> Callable[[Function], Function]:
    """Shows the options of tables in a function's signature and docs instead of `**options`."""

    def decorate(function: Function) -> Function:
        signature = inspect.signature(function)
        # The docs also describe options that are explicit parameters of the function.
        documented = rows_of(*tables)
        rows = [row for row in documented if row["name"] not in signature.parameters]
        kept = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
        shown = [inspect.Parameter(row["name"], inspect.Parameter.KEYWORD_ONLY, default=None,
                                   annotation=row["type"]) for row in rows]
        function.__signature__ = signature.replace(parameters=kept + shown)  # type: ignore
        lines = [textwrap.fill(f"{row['name']}: {row['help']}", 96, initial_indent="    ",
                               subsequent_indent="        ", break_on_hyphens=False)
                 for row in documented]
        doc = textwrap.dedent(" " * 4 + (function.__doc__ or "")).strip()
        function.__doc__ = (doc + "\n\nOptions (None: the command's default):\n"
                            + "\n".join(lines) + "\n")
        return function

    return decorate
