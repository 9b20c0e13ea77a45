"""One HTML page of statistics of a data set, of bounded size for any number of clips."""

from __future__ import annotations

import hashlib
import html
import math
import os
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from retarget import _retarget
from retarget._errors import UsageError
from retarget.data_set.duplicates import find_groups
from retarget.data_set.results import Result, read_results
from retarget.packs._parts import new_file

ROWS = 50
SOURCES = 30
GATES = 20
_BINS = 40
_LONGEST = 120
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; margin: 0.5rem 0 2rem; font-variant-numeric: tabular-nums; }
th, td { padding: 0.15rem 0.7rem; text-align: right; border-bottom: 1px solid #ddd; }
th:first-child, td:first-child, td.text { text-align: left; overflow-wrap: anywhere; }
figure { display: inline-block; margin: 0 1.5rem 1rem 0; }
svg rect { fill: #3a7ca5; }
.scroll { overflow-x: auto; }
"""


def _is_other_file(file: Path) -> bool:
    if not file.is_file():
        return file.exists()
    with file.open("rb") as existing:
        return not existing.read(15).lower().startswith(b"<!doctype html")


def write_page(folder: str | os.PathLike[str], file: str | os.PathLike[str], *,
               near_duplicates: bool = True) -> Path:
    """Writes statistics of a data set as one HTML file without scripts, below 1 MB.

    Histograms of duration, joint speed, contacts and solving time of solved clips; missed gates and
    failures by source, which is the first folder of a clip's name; near duplicates; the worst clips,
    and a sample that depends only on the names.

    Args:
        folder: output folder of `retarget batch` or retarget_dataset().
        file: the page; an existing page is replaced.
        near_duplicates: search for clips that show the same motion (find_groups()).

    Returns:
        The path of the page.

    Raises:
        InputError: the folder has no manifest.
        UsageError: the file exists and is no HTML page.
        ConfigError: the manifest is Parquet, and pyarrow is not installed.
    """
    if _is_other_file(Path(file)):
        raise UsageError(f'"{file}" exists and is no HTML page')
    results = read_results(Path(folder))
    title = f"Data set {Path(folder).resolve().name}"
    text = "\n".join([
        '<!DOCTYPE html><html lang="en"><meta charset="utf-8">',
        f"<title>{_text(title)}</title><style>{_STYLE}</style><h1>{_text(title)}</h1>",
        _totals(results), _histograms(results), _sources(results), _errors(results),
        _twins(results), _groups(results) if near_duplicates else "",
        _worst(results), _sample(results), "</html>\n"])
    with new_file(Path(file)) as unfinished:
        unfinished.write_text(text, encoding="utf-8", errors="replace")
    return Path(file)


def _text(value: object) -> str:
    text = str(value)
    return html.escape(text if len(text) <= _LONGEST else f"{text[:_LONGEST - 3]}...")


def _number(value: float) -> str:
    return "-" if math.isnan(value) else "∞" if math.isinf(value) else f"{value:,.4g}"


def _table(head: Sequence[str], rows: Iterable[Sequence[object]], texts: int = 1) -> str:
    """Returns a table; its head is HTML, and the first `texts` columns are text."""
    lines = ["".join(f"<th>{cell}</th>" for cell in head)]
    for row in rows:
        lines.append("".join(f'<td{" class=text" if i < texts else ""}>{_text(cell)}</td>'
                             for i, cell in enumerate(row)))
    return f'<div class=scroll><table>{"".join(f"<tr>{line}</tr>" for line in lines)}</table></div>'


def _totals(results: Sequence[Result]) -> str:
    status = Counter(result.status for result in results)
    hours = sum(result.duration for result in results) / 3600.0
    solving = sum(result.seconds for result in results) / 3600.0
    passed = [result for result in results if result.passed]
    return _table(["", "clips", "hours"], [
        ("all", f"{len(results):,}", _number(hours)),
        ("passed", f"{len(passed):,}", _number(sum(each.duration for each in passed) / 3600.0)),
        ("miss a gate", f"{status['done'] - len(passed):,}", ""),
        ("failed", f"{status['failed'] + status['lost']:,}", ""),
        ("duplicates, not solved", f"{status['duplicate']:,}", ""),
        ("solving time", "", _number(solving))])


def _histograms(results: Sequence[Result]) -> str:
    done = [result for result in results if result.status == "done"]
    return "<h2>Solved clips</h2>" + "".join([
        _histogram("Duration", "s", [result.duration for result in done]),
        _histogram("Largest joint speed", "rad/s", [result.figures[0] for result in done]),
        _histogram("Feet in contact", "% of feet and frames",
                   [result.figures[1] for result in done]),
        _histogram("Solving time", "s", [result.seconds for result in done])])


def _histogram(title: str, unit: str, values: Sequence[float]) -> str:
    """Draws counts from 0 to the 99th percentile; the last bar has all larger values."""
    known = np.array([value for value in values if math.isfinite(value)])
    if len(known) == 0:
        return f"<figure><figcaption>{title}: not measured</figcaption></figure>"
    low, top = min(0.0, float(known.min())), float(np.percentile(known, 99.0))
    top = top if top > low else low + 1.0
    counts, _ = np.histogram(np.minimum(known, top), bins=_BINS, range=(low, top))
    bars = "".join(
        f'<rect x="{7 * i}" y="{100 - 100 * count / counts.max():.1f}" width="6" '
        f'height="{100 * count / counts.max():.1f}"><title>{count:,}</title></rect>'
        for i, count in enumerate(counts))
    caption = (f"{title}: median {_number(float(np.median(known)))}, largest "
               f"{_number(float(known.max()))} {unit}<br>{_number(low)} to {_number(top)}, "
               "the last bar includes larger values")
    return (f'<figure><svg width="{7 * _BINS}" height="100">{bars}</svg>'
            f"<figcaption>{caption}</figcaption></figure>")


def _sources(results: Sequence[Result]) -> str:
    clips = Counter(result.source for result in results)
    passed = Counter(result.source for result in results if result.passed)
    failed = Counter(result.source for result in results if result.status in ("failed", "lost"))
    missed = Counter((result.source, gate) for result in results if result.status == "done"
                     for gate in result.missed)
    gates = Counter(gate for result in results if result.status == "done"
                    for gate in result.missed)
    shown = [gate for gate, _ in gates.most_common(GATES)]
    meaning = {key: text for key, _, text in _retarget.metrics()}
    head = ["source", "clips", "passed", "failed", *(
        f'<span title="{html.escape(meaning.get(gate, ""))}">{_text(gate)}</span>'
        for gate in shown)]
    rows = [(source, f"{count:,}", f"{passed[source]:,}", f"{failed[source]:,}",
             *(f"{missed[source, gate]:,}" for gate in shown))
            for source, count in clips.most_common(SOURCES)]
    rows.append(("all", f"{len(results):,}", f"{passed.total():,}", f"{failed.total():,}",
                 *(f"{gates[gate]:,}" for gate in shown)))
    left = len(clips) - SOURCES
    more = f"<p>{left:,} smaller sources are only in the last row.</p>" if left > 0 else ""
    return f"<h2>Failures and missed gates by source</h2>{_table(head, rows)}{more}"


def _errors(results: Sequence[Result]) -> str:
    """Counts messages; numbers and quoted names in them differ from clip to clip."""
    kinds = Counter(re.sub(r'"[^"]*"|\d+', "…", result.message.split("\n")[0])
                    for result in results if result.status in ("failed", "lost"))
    if not kinds:
        return ""
    return "<h2>Errors</h2>" + _table(["message", "clips"], (
        (message, f"{count:,}") for message, count in kinds.most_common(20)))


def _twins(results: Sequence[Result]) -> str:
    twins = sorted(((result.twin[1], result.name, result.twin[0]) for result in results
                    if result.twin is not None))
    if not twins:
        return ""
    return f"<h2>Repeated clips: {len(twins):,}</h2>" + _table(
        ["clip", "repeats", "distance, degrees"],
        ((name, of, f"{distance:.2f}") for distance, name, of in twins[:ROWS]), 2)


def _groups(results: Sequence[Result]) -> str:
    groups = find_groups(results)
    if not groups:
        known = any(result.signature for result in results)
        return f"<h2>Near duplicates: {'none' if known else 'unknown'}</h2>"
    repeats = [repeat for group in groups for repeat in group.repeats]
    clips = Counter(result.source for result in results)
    by_source = Counter(repeat.source for repeat in repeats)
    hours = sum(repeat.duration for repeat in repeats) / 3600.0
    return "\n".join([
        f"<h2>Near duplicates: {len(repeats):,} of {len(results):,} clips</h2>",
        f"<p>Groups: {len(groups):,}; repeats: {_number(hours)} hours. The motions of a group, or "
        "their mirror images, differ by less than 2.5 degrees; <code>retarget batch "
        "--dedupe</code> keeps the first clip of each group.</p>",
        _table(["source", "clips", "repeats"], (
            (source, f"{clips[source]:,}", f"{count:,}")
            for source, count in by_source.most_common(SOURCES))),
        _table(["repeated clip", "first repeat", "repeats", "mirrored", "sources",
                "largest distance, degrees"], (
            (group.first.name, group.repeats[0].name, f"{len(group.repeats):,}",
             f"{group.mirrored:,}", group.sources, f"{group.farthest:.2f}")
            for group in groups[:ROWS]), 2)])


def _rows(results: Iterable[Result]) -> str:
    return _table(["clip", "worst gate", "value / bound", "missed gates", "duration, s"], (
        (each.name, each.worst or "-", _number(each.worst_ratio) if each.worst else "-",
         len(each.missed), _number(each.duration)) for each in results), 2)


def _worst(results: Sequence[Result]) -> str:
    missing = [result for result in results if result.status == "done" and result.missed]
    missing.sort(key=lambda result: (-len(result.missed), -result.worst_ratio, result.name))
    return "<h2>Worst clips</h2>" + _rows(missing[:ROWS])


def _sample(results: Sequence[Result]) -> str:
    done = [result for result in results if result.status == "done"]
    done.sort(key=lambda result: hashlib.sha256(
        result.name.encode(errors="replace")).digest())
    return "<h2>Sample</h2>" + _rows(sorted(done[:ROWS], key=lambda result: result.name))
