"""The manifest of a large data set: Parquet files of results, one row per clip and try.

The last row of a clip is valid. Parts are numbered in the order in which they were written.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from retarget._errors import InputError
from retarget.packs._parquet import arrow, write_table
from retarget.packs._parts import UNFINISHED

if TYPE_CHECKING:
    import pyarrow as pa

FOLDER = "manifest"
_ROWS = 10_000
_SECONDS = 5.0


def schema() -> pa.Schema:
    """Returns the columns of a manifest.

    name: path of the clip below its input. status: "done"; "failed", an error or the last try of a
    clip whose process ended; "lost", its process ended and the clip is tried again. tries: how many
    times it was begun. location, offset, input_bytes, input_version: members of ClipSource.
    options: hash of everything that determines the bytes. outputs: files below the output folder.
    frames, fps (1/s), seconds (solving time), taken_as, mapping, warnings, figures, gates_missed,
    worst, worst_ratio, signature: as in manifest.jsonl (docs/batch.md). message, exit_code: the
    error of the clip.
    """
    pa = arrow()
    text, whole, real = pa.string(), pa.int64(), pa.float64()
    output = pa.struct([("file", text), ("bytes", whole), ("hash", text)])
    return pa.schema([
        ("name", text), ("status", text), ("tries", pa.int32()), ("location", text),
        ("offset", whole), ("input_bytes", whole), ("input_version", text), ("options", text),
        ("robot", text), ("outputs", pa.list_(output)), ("frames", whole), ("fps", real),
        ("seconds", real), ("message", text), ("exit_code", pa.int32()), ("taken_as", text),
        ("mapping", text), ("warnings", pa.list_(text)), ("figures", pa.map_(text, real)),
        ("gates_missed", pa.list_(text)), ("worst", text), ("worst_ratio", real),
        ("signature", text)])


def manifest_parts(folder: str | os.PathLike[str]) -> list[Path]:
    """Returns the files of the manifest of an output folder, in the order of writing."""
    return sorted((Path(folder) / FOLDER).glob("part-*.parquet"))


def manifest_rows(folder: str | os.PathLike[str],
                  columns: Sequence[str] | None = None) -> Iterator[dict[str, Any]]:
    """Yields all rows in the order of writing, as dictionaries; one part is in memory."""
    arrow()
    import pyarrow.parquet as parquet

    for part in manifest_parts(folder):
        for batch in parquet.ParquetFile(part).iter_batches(columns=columns):
            yield from batch.to_pylist()


def read_manifest(folder: str | os.PathLike[str],
                  columns: Sequence[str] | None = None) -> pa.Table:
    """Returns the last row of every clip as a table of pyarrow, sorted by name.

    Args:
        folder: output folder of retarget_dataset().
        columns: columns to read besides `name`; None: all (schema() describes them).

    Raises:
        InputError: the folder has no manifest.
        ConfigError: pyarrow is not installed.
    """
    pa = arrow()
    import pyarrow.parquet as parquet

    parts = manifest_parts(folder)
    if not parts:
        raise InputError(f"{folder}: no manifest", file=os.fspath(folder))
    wanted = None if columns is None else ["name", *(each for each in columns if each != "name")]
    table = pa.concat_tables(parquet.read_table(part, columns=wanted) for part in parts)
    last: dict[str, int] = {}
    for index, name in enumerate(table["name"].to_pylist()):
        last[name] = index
    return table.take([last[name] for name in sorted(last)])


class ManifestWriter:
    """Appends rows; a part is written when it has enough rows, when it is due, and at the end.

    The caller holds the lock of the folder: a writer removes unfinished files of earlier ones.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder / FOLDER
        self._schema = schema()
        self._rows: list[dict[str, Any]] = []
        self._written = time.monotonic()
        for left in self._folder.glob(f".*{UNFINISHED}"):
            left.unlink(missing_ok=True)
        parts = manifest_parts(folder)
        self._next = int(parts[-1].stem.split("-")[1]) + 1 if parts else 0

    def add(self, row: dict[str, Any]) -> None:
        """Keeps a row for the next part."""
        self._rows.append(row)
        self.flush_if_due()

    def flush_if_due(self) -> None:
        """Writes the rows that are old or many enough for a part."""
        if len(self._rows) >= _ROWS or time.monotonic() - self._written > _SECONDS:
            self.flush()

    def flush(self) -> None:
        """Writes the rows that were added since the last part."""
        if self._rows:
            pa = arrow()
            table = pa.Table.from_pylist(self._rows, schema=self._schema)
            write_table(table, self._folder / f"part-{self._next:06d}.parquet",
                        use_dictionary=True)
            self._next += 1
            self._rows = []
        self._written = time.monotonic()
