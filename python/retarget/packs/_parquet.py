"""Parquet files with the same bytes for the same rows."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from retarget._errors import ConfigError
from retarget.packs._parts import new_file

if TYPE_CHECKING:
    import pyarrow as pa


def arrow() -> ModuleType:
    """Returns pyarrow.

    Raises:
        ConfigError: it is not installed.
    """
    try:
        import pyarrow
        import pyarrow.parquet  # noqa: F401
    except ImportError as error:
        raise ConfigError(f"Parquet files need pyarrow (pip install pyarrow): {error}") from error
    return pyarrow


def rows_of(values: np.ndarray) -> pa.Array:
    """Returns (F,), (F, N) or (F, M, N) values as F numbers, lists, or lists of lists.

    The innermost lists have a fixed size.
    """
    pa = arrow()
    if values.ndim == 1:
        return pa.array(values)
    inner = pa.FixedSizeListArray.from_arrays(pa.array(np.ascontiguousarray(values).reshape(-1)),
                                              values.shape[-1])
    if values.ndim == 2:
        return inner
    offsets = np.arange(0, values.shape[0] * values.shape[1] + 1, values.shape[1], dtype=np.int32)
    return pa.ListArray.from_arrays(pa.array(offsets), inner)


def write_table(table: pa.Table, file: Path, **options: Any) -> None:
    """Writes a table completely or not at all; `options` are those of pyarrow's write_table."""
    import pyarrow.parquet as parquet

    settings = {"compression": "zstd", "use_dictionary": False, **options}
    with new_file(file) as unfinished:
        parquet.write_table(table, unfinished, **settings)
