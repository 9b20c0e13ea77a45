"""Results of functions that consist of text and numbers."""

from __future__ import annotations

import html
import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from retarget import _retarget


@dataclass(frozen=True)
class Fault:
    """A fault of a motion in the frames [begin, end)."""

    metric: str
    where: str
    begin: int
    end: int
    worst_frame: int
    amount: float
    unit: str


class Report:
    """Metrics, faults and gates of a motion (definitions: docs/quality.md)."""

    def __init__(self, text: str, json_text: str) -> None:
        self._text = text
        self.json = json_text
        """The report as `retarget evaluate --json` writes it."""

    @cached_property
    def data(self) -> dict[str, Any]:
        """The complete report, as in its JSON."""
        return json.loads(self.json)["motions"][0]

    @property
    def figures(self) -> dict[str, float]:
        """Metric values by key; `KEY_p95` is the 95th percentile, if defined.

        `retarget.metrics()` defines them. Metrics that could not be measured are omitted.
        """
        figures = {}
        for key, _, _ in _retarget.metrics():
            value = self.data.get(key)
            if isinstance(value, list):
                figures[key], figures[f"{key}_p95"] = value
            elif value is not None:
                figures[key] = value
        return figures

    @property
    def faults(self) -> list[Fault]:
        """Faulty frame ranges by metric, the worst first."""
        return [Fault(**fault) for fault in self.data["faults"]]

    @property
    def passed(self) -> bool:
        """Whether the motion passes all gates."""
        return self.data["passed"]

    @property
    def missed(self) -> list[dict[str, Any]]:
        """Missed gates: metric, min, max, value."""
        return [gate for gate in self.data["gates"] if not gate["passed"]]

    def __str__(self) -> str:
        return self._text

    def _repr_html_(self) -> str:
        """A table of the gates, for notebooks."""
        rows = []
        for gate in self.data["gates"]:
            value = gate.get("value")
            bounds = [f"{sign} {gate[key]:g}" for sign, key in (("&ge;", "min"), ("&le;", "max"))
                      if gate.get(key) is not None]
            cells = (gate["metric"], "" if value is None else f"{value:.4g}",
                     _units().get(gate["metric"], ""), " ".join(bounds),
                     "passed" if gate["passed"] else "<b>missed</b>")
            rows.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
        head = "".join(f"<th>{name}</th>" for name in ("metric", "value", "unit", "gate", ""))
        return (f"<table><caption>{html.escape(self.data['file'])}: {self._verdict()}</caption>"
                f"<thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>")

    def _verdict(self) -> str:
        verdict = "passed" if self.passed else f"{len(self.missed)} gates missed"
        return verdict + (", soles estimated" if self.data.get("estimated_soles") else "")

    def __repr__(self) -> str:
        return f"<retarget.Report of {self.data['file']!r}: {self._verdict()}>"


def _units() -> dict[str, str]:
    return {key: html.escape(unit) for key, unit, _ in _retarget.metrics()}


class Inspection:
    """Contents of a clip: `str()` for reading, `data` as in `retarget inspect --json`."""

    def __init__(self, text: str, json_text: str) -> None:
        self._text = text
        self.json = json_text
        """The description as `retarget inspect --json` writes it."""

    @cached_property
    def data(self) -> dict[str, Any]:
        """The complete description, as in its JSON."""
        return json.loads(self.json)

    def __str__(self) -> str:
        return self._text


@dataclass(frozen=True)
class Batch:
    """Result of a batch."""

    folder: Path
    failed: int
    """Number of clips that failed in this run."""
    clips: list[dict[str, Any]]
    """The lines of the manifest (docs/batch.md)."""
    notes: list[str]
    """Messages that the command prints."""

    def __repr__(self) -> str:
        return (f"<retarget.Batch in {str(self.folder)!r}: {len(self.clips)} clips, "
                f"{self.failed} failed>")


def manifest_lines(file: Path, errors: str) -> Iterator[dict[str, Any]]:
    """Yields the entries of a manifest and skips truncated lines of a killed batch.

    Args:
        errors: how to decode names that are not UTF-8.
    """
    if not file.is_file():
        return
    with file.open(encoding="utf-8", errors=errors, newline="\n") as lines:
        for line in lines:
            try:
                entry = json.loads(line)
            except ValueError:
                continue
            if isinstance(entry, dict):
                yield entry
