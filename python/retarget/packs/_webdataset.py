"""WebDataset: tar files with one sample per clip."""

from __future__ import annotations

import io
import json
import os
import re
import tarfile
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from retarget import _retarget
from retarget._errors import RunError, UsageError
from retarget.packs._clips import BatchClips, Clips, Source, StrPath, ascending
from retarget.packs._parts import new_folder, parts

# As in WebDataset's tar_file_iterator: members for other purposes.
_SKIPPED = re.compile(r"__[^/]*__/")
_BLOCK = 512
# Two empty blocks, and zeros up to a multiple of the record size.
_END_OF_TAR = 2 * _BLOCK + tarfile.RECORDSIZE


@dataclass(frozen=True)
class _Sample:
    """The members of a clip: bytes by file extension."""

    key: str
    members: dict[str, bytes]

    @property
    def tar_bytes(self) -> int:
        """Upper bound of the bytes in a tar: each member may need an extended header."""
        return sum(4 * _BLOCK + -(-len(data) // _BLOCK) * _BLOCK for data in self.members.values())


def write_webdataset(clips: Clips, folder: StrPath, *, format: str = "npz-mjlab",
                     info: Callable[[str], Mapping[str, Any]] | None = None,
                     max_bytes: int = 2**30, max_clips: int = 100_000,
                     replace: bool = False) -> list[Path]:
    """Writes shards of WebDataset: shard-000000.tar, shard-000001.tar, ...

    A clip is one sample. Its key is the clip's name, with "_" for dots after the last "/", because
    WebDataset ends the key there. Its members are the motion file, with unchanged bytes, and
    `json` with `name` and the members of `info`.

    Args:
        clips: motions by name; a Motion is saved in `format`.
        folder: new folder of the shards.
        format: file format (docs/formats.md) for clips that are Motion objects; not csv-sonic.
        info: further members of a clip's JSON, by its name.
        max_bytes: largest size of a shard in bytes; a larger clip has its own shard.
        max_clips: largest number of clips in a shard.
        replace: replace an earlier pack or an empty folder.

    Returns:
        The shards, in order.

    Raises:
        UsageError: names out of order, two clips with one key, a key that readers skip, bounds
            below 1, an existing folder.
        InputError: a file has changed since the batch wrote it.
        RunError: a file cannot be read or written.
    """
    keys: dict[str, str] = {}
    batch = clips if isinstance(clips, BatchClips) else BatchClips()
    samples = (_sample(name, source, format, info, keys, batch)
               for name, source in ascending(clips))
    shards = []
    with new_folder(folder, replace) as unfinished:
        bound = max(min(max_bytes, 1), max_bytes - _END_OF_TAR)
        groups = parts(samples, lambda each: each.tar_bytes, bound, max_clips)
        for number, part in enumerate(groups):
            name = f"shard-{number:06d}.tar"
            _write_tar(unfinished / name, part)
            shards.append(Path(folder) / name)
    return shards


def _sample(name: str, source: Source, format: str,
            info: Callable[[str], Mapping[str, Any]] | None, keys: dict[str, str],
            batch: BatchClips) -> _Sample:
    parent, _, last = name.rpartition("/")
    key = f"{parent}/{last.replace('.', '_')}" if parent else last.replace(".", "_")
    if _SKIPPED.match(key):
        raise UsageError(f"clips: readers of WebDataset skip {name!r}, because the first folder of "
                         "its name begins and ends with two underscores")
    # Names ascend, so only a key that differs from its name, or one equal to such a key, repeats.
    if key != name or key in keys:
        if keys.setdefault(key, name) != name:
            raise UsageError(f"clips: {name!r} and {keys[key]!r} have the same key {key!r}")
    ending, data = _motion_file(name, source, format)
    if not isinstance(source, _retarget.Motion):
        batch.check_unchanged(name, source, data)
    about = {"name": name, **(info(name) if info else {})}
    text = json.dumps(about, ensure_ascii=False, sort_keys=True).encode(errors="surrogateescape")
    return _Sample(key, {ending: data, "json": text})


def _motion_file(name: str, source: Source, format: str) -> tuple[str, bytes]:
    """Returns the extension of a motion file without the first dot, and its bytes."""
    if isinstance(source, _retarget.Motion):
        ending = {"protomotions": "motion"}.get(format, format.split("-")[0])
        with tempfile.TemporaryDirectory(prefix="retarget-") as folder:
            file = Path(folder) / f"motion.{ending}"
            source.save(file, format=format)
            return ending, file.read_bytes()
    file = Path(source)
    last = name.rpartition("/")[2]
    rest = file.name[len(last):] if file.name.startswith(last + ".") else file.suffix
    try:
        return rest.lstrip(".").lower() or "motion", file.read_bytes()
    except OSError as error:
        raise RunError(f"{file}: {error.strerror or error}", file=os.fspath(file)) from error


def _members(part: list[_Sample]) -> Iterator[tuple[str, bytes]]:
    for sample in part:
        for ending, data in sample.members.items():
            yield f"{sample.key}.{ending}", data


def _write_tar(file: Path, part: list[_Sample]) -> None:
    """Writes a tar without times, users and other properties of this machine."""
    with tarfile.open(file, "w", format=tarfile.PAX_FORMAT) as tar:
        for name, data in _members(part):
            member = tarfile.TarInfo(name)
            member.size = len(data)
            tar.addfile(member, io.BytesIO(data))
