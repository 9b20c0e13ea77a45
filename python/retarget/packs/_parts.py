"""Files and folders that appear when they are complete, and clips grouped in parts."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from retarget._errors import Error, RunError, UsageError

Item = TypeVar("Item")
UNFINISHED = ".unfinished"
_FILES_OF_PACKS = re.compile(
    r"meta/(info|stats)\.json|meta/tasks\.parquet"
    r"|(data|meta/episodes)/chunk-\d+/file-\d+\.parquet"
    r"|part-\d+/sequence_id=[^/]+/robot_name=[^/]+/data\.parquet"
    r"|shard-\d+\.tar")


@contextmanager
def new_folder(folder: str | os.PathLike[str], replace: bool) -> Iterator[Path]:
    """Makes a folder that appears under its name when the block ends without an exception.

    The block gets the path of a hidden folder next to it. The next call with the same name removes
    the hidden folder of a killed process.

    Args:
        replace: replace an earlier pack or an empty folder; otherwise the folder is an error.

    Raises:
        UsageError: as for check_target().
        RunError: it cannot be made or moved.
    """
    target = Path(os.path.abspath(folder))
    check_target(target, replace)
    unfinished = target.with_name(f".{target.name}{UNFINISHED}")
    earlier = target.with_name(f".{target.name}.replaced")
    try:
        shutil.rmtree(unfinished, ignore_errors=True)
        unfinished.mkdir(parents=True)
        yield unfinished
        if target.exists():
            shutil.rmtree(earlier, ignore_errors=True)
            target.rename(earlier)
        unfinished.rename(target)
        shutil.rmtree(earlier, ignore_errors=True)
    except OSError as error:
        if isinstance(error, Error):  # Of a clip that the block reads.
            raise
        raise RunError(f"{target}: {error.strerror or error}", file=str(target)) from error
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


def check_target(folder: Path, replace: bool) -> None:
    """Checks that a pack can have this folder.

    Raises:
        UsageError: the folder exists, or has a file that is not of a pack.
    """
    if folder.exists() and not (replace and folder.is_dir()):
        raise UsageError(f'"{folder}" exists; replace=True replaces a pack')
    if (foreign := _foreign_file(folder)) is not None:
        raise UsageError(f'"{folder}" is not replaced: "{foreign}" in it is not of a pack')


def _foreign_file(folder: Path) -> str | None:
    """Returns the path of a file that no writer of packs makes, relative to the folder."""
    if folder.is_symlink():
        return "."
    for parent, folders, files in os.walk(folder):
        links = [name for name in folders if os.path.islink(os.path.join(parent, name))]
        for name in sorted(files + links):
            path = Path(parent, name).relative_to(folder).as_posix()
            if not _FILES_OF_PACKS.fullmatch(path):
                return path
    return None


@contextmanager
def new_file(file: Path) -> Iterator[Path]:
    """Makes a file that appears under its name when the block ends without an exception.

    The block writes to the path that it gets. The bytes are on the disk before the name is.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    unfinished = file.with_name(f".{file.name}.{os.getpid()}{UNFINISHED}")
    try:
        yield unfinished
        with unfinished.open("rb") as written:
            os.fsync(written.fileno())
        unfinished.replace(file)
    finally:
        unfinished.unlink(missing_ok=True)


def parts(items: Iterable[Item], size_of: Callable[[Item], int], max_bytes: int,
          max_clips: int) -> Iterator[list[Item]]:
    """Groups consecutive items; a part that would exceed a bound ends before the item.

    An item that alone exceeds `max_bytes` is a separate part.

    Raises:
        UsageError: a bound below 1.
    """
    for bound, value in (("max_bytes", max_bytes), ("max_clips", max_clips)):
        if value < 1:
            raise UsageError(f"{bound}: expected at least 1, found {value}")
    part: list[Item] = []
    total = 0
    for item in items:
        size = size_of(item)
        if part and (total + size > max_bytes or len(part) >= max_clips):
            yield part
            part, total = [], 0
        part.append(item)
        total += size
    if part:
        yield part
