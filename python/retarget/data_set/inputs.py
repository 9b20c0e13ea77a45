"""Clips in folders, in remote storage and in tar files."""

from __future__ import annotations

import glob
import os
import tarfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from types import ModuleType
from typing import IO, Any

from retarget._errors import ConfigError, InputError, UsageError

StrPath = str | os.PathLike[str]

# The files that `retarget batch` takes from a folder.
ENDINGS = (".bvh", ".fbx", ".glb", ".gltf", ".vrm", ".vrma", ".mvnx", ".npz", ".pt", ".npy")
_TAR = ".tar"
_PATTERN = "*?["
# Members of fsspec's answers that change with the content of a file.
_VERSIONS = ("ETag", "etag", "md5Hash", "blob_id", "checksum", "mtime", "LastModified",
             "last_modified", "created")


@dataclass(frozen=True, slots=True)
class ClipSource:
    """A motion file, alone or in a tar."""

    name: str
    """Path below the input, "a/walk.bvh": it gives the output its name."""
    location: str
    """Path or URL of the file or of the tar."""
    bytes: int
    version: str
    """Changes with the content of `location`: modification time or the storage's own mark."""
    offset: int = -1
    """Position of the bytes in a tar; -1: the whole file."""


@dataclass(frozen=True, slots=True)
class _File:
    """A file as a listing names it."""

    name: str
    location: str
    bytes: int
    version: str


def find_clips(inputs: StrPath | Iterable[StrPath],
               storage_options: Mapping[str, Any] | None = None) -> list[ClipSource]:
    """Lists the clips of inputs, sorted by name.

    Args:
        inputs: local folders (searched recursively), files and patterns, URLs of the same kinds for
            fsspec ("s3://bucket/clips/", "hf://datasets/me/clips/*.bvh"), which may contain tar
            files, such as shards of WebDataset. Only motion files are used (docs/formats.md), named
            by their path below the folder, below the fixed part of a pattern, or inside the tar.
        storage_options: options of fsspec for URLs.

    Raises:
        InputError: an input does not exist or cannot be read, or contains no clips.
        UsageError: two clips would have the same output, or a name is not UTF-8.
        ConfigError: an input is a URL and fsspec, or its file system, is not installed.
    """
    inputs = [inputs] if isinstance(inputs, (str, os.PathLike)) else list(inputs)
    clips: list[ClipSource] = []
    for each in inputs:
        before = len(clips)
        for file in _files(os.fspath(each), storage_options):
            clips.extend(_clips(file, storage_options))
        if len(clips) == before:
            raise InputError(f"{each}: no motion files", file=os.fspath(each))
    for clip in clips:
        if any("\ud800" <= letter <= "\udfff" for letter in clip.name):
            raise UsageError(f"{clip.name!r} is not UTF-8, and Parquet cannot store it: rename it")
    clips.sort(key=lambda clip: (_stem(clip.name), clip.name))
    for earlier, later in zip(clips, clips[1:]):
        if _stem(earlier.name) == _stem(later.name):
            raise UsageError(f'"{earlier.name}" of {earlier.location} and "{later.name}" of '
                             f"{later.location} would have the same output")
    return clips


def place(clip: ClipSource, folder: Path, storage_options: Mapping[str, Any] | None) -> None:
    """Puts a clip in a folder under its name: a link to a local file, otherwise its bytes.

    Raises:
        OSError: it cannot be read.
    """
    file = folder / clip.name
    file.parent.mkdir(parents=True, exist_ok=True)
    if clip.offset < 0 and not _is_url(clip.location):
        file.symlink_to(os.path.abspath(clip.location))
        return
    with _open(clip.location, storage_options) as source:
        source.seek(max(clip.offset, 0))
        content = source.read(clip.bytes)
    if len(content) != clip.bytes:
        raise OSError(f"{clip.location} has changed: it ends within {clip.name}")
    file.write_bytes(content)


def _stem(name: str) -> str:
    return str(PurePosixPath(name).with_suffix(""))


def _is_url(text: str) -> bool:
    return "://" in text


def _is_motion(name: str) -> bool:
    last = name.rpartition("/")[2]
    return last.lower().endswith(ENDINGS) and not last.startswith("._")


def _clips(file: _File, storage_options: Mapping[str, Any] | None) -> Iterator[ClipSource]:
    if not file.name.lower().endswith(_TAR):
        if _is_motion(file.name):
            yield ClipSource(file.name, file.location, file.bytes, file.version)
        return
    try:
        with _open(file.location, storage_options) as content, \
                tarfile.open(fileobj=content, mode="r:") as tar:
            for member in tar:
                if member.isfile() and _is_motion(member.name):
                    yield ClipSource(_safe_name(member.name, file.location), file.location,
                                     member.size, file.version, member.offset_data)
    except (tarfile.TarError, OSError) as error:
        raise InputError(f"{file.location}: {error}", file=file.location) from error


def _safe_name(name: str, tar: str) -> str:
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts:
        raise InputError(f'{tar}: "{name}" would be written outside the output folder', file=tar)
    return str(path)


def _files(text: str, storage_options: Mapping[str, Any] | None) -> Iterator[_File]:
    if _is_url(text):
        yield from _remote_files(text, storage_options)
    elif os.path.isdir(text):
        yield from _folder_files(text)
    elif os.path.exists(text):
        yield _local_file(os.path.basename(text), text)
    elif any(mark in text for mark in _PATTERN):
        root = _fixed_part(text)
        for path in sorted(glob.glob(text, recursive=True)):
            if os.path.isfile(path):
                yield _local_file(os.path.relpath(path, root or "."), path)
    else:
        raise InputError(f"{text}: no such file or folder", file=text)


def _folder_files(root: str) -> Iterator[_File]:
    for folder, folders, names in os.walk(root, followlinks=True):
        folders.sort()
        for name in sorted(names):
            if name.lower().endswith((*ENDINGS, _TAR)):
                path = os.path.join(folder, name)
                yield _local_file(os.path.relpath(path, root), path)


def _local_file(name: str, path: str) -> _File:
    status = os.stat(path)
    return _File(name, path, status.st_size, str(status.st_mtime_ns))


def _fixed_part(pattern: str) -> str:
    """Returns the folder in front of the first part with a wildcard."""
    first = min(pattern.find(mark) for mark in _PATTERN if mark in pattern)
    return pattern[:first].rpartition("/")[0]


def _fsspec() -> ModuleType:
    try:
        import fsspec
    except ImportError as error:
        raise ConfigError("URLs need fsspec and the package of their file system, such as s3fs "
                          f"(pip install fsspec s3fs): {error}") from error
    return fsspec


def _remote_files(url: str, storage_options: Mapping[str, Any] | None) -> Iterator[_File]:
    fsspec = _fsspec()
    try:
        system, path = fsspec.core.url_to_fs(url, **(storage_options or {}))
        if any(mark in path for mark in _PATTERN):
            root, found = _fixed_part(path), system.glob(path, detail=True)
        elif system.isdir(path):
            root, found = path.rstrip("/"), system.find(path, detail=True)
        else:
            root, found = path.rpartition("/")[0], {path: system.info(path)}
    except (OSError, ImportError, ValueError) as error:
        raise InputError(f"{url}: {error}", file=url) from error
    for path, about in sorted(found.items()):
        if about["type"] != "directory":
            version = next((str(about[key]) for key in _VERSIONS if about.get(key)), "")
            yield _File(path[len(root):].lstrip("/"), system.unstrip_protocol(path),
                        about["size"], version)


def _open(location: str, storage_options: Mapping[str, Any] | None) -> IO[bytes]:
    if not _is_url(location):
        return open(location, "rb")
    return _fsspec().open(location, "rb", **(storage_options or {})).open()
