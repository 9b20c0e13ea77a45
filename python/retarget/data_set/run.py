"""The state of a data set: finished clips, remaining clips, and the lists at the end."""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import shutil
from collections import Counter, deque
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import retarget
from retarget import _retarget
from retarget._errors import RunError
from retarget.data_set.inputs import ClipSource
from retarget.data_set.manifest import ManifestWriter, manifest_rows, read_manifest
from retarget.data_set.solve import Request, interrupted, new_row
from retarget.packs._parts import new_file

Task = list[tuple[ClipSource, int]]
"""Clips, and the number of earlier attempts for each."""

_BYTES_PER_TASK = 64 * 2**20


def fingerprint(robot: str, options: Mapping[str, Any]) -> str:
    """Returns a hash of everything that determines the bytes of a motion, except its clip.

    Raises:
        ConfigError: an unknown robot.
    """
    loaded = _retarget.Robot(robot)
    content = hashlib.sha256()
    content.update(json.dumps([retarget.version_text(), robot, sorted(options.items())],
                              default=str).encode())
    for value in (value for _, value in sorted(options.items())):
        if isinstance(value, (str, os.PathLike)) and os.path.isfile(value):
            content.update(Path(value).read_bytes())
    for file in sorted(Path(loaded.model).parent.iterdir()):
        if file.suffix in (".xml", ".json", ".urdf"):
            content.update(file.name.encode() + b"\0" + file.read_bytes())
    return f"sha256:{content.hexdigest()}"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Holds the lock of an output folder.

    Raises:
        RunError: another process holds it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("w") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise RunError(f'another process writes to "{folder}"', file=str(folder)) from error
        yield


class Progress:
    """The remaining clips of a data set.

    A clip is finished if the manifest has it with the same options and input, and as failed, or as
    done with outputs of the recorded size. All other clips are tasks.
    """

    def __init__(self, request: Request, clips: list[ClipSource], most_tries: int,
                 retry_failed: bool) -> None:
        self.request = request
        self.folder = Path(request.folder)
        self.manifest = ManifestWriter(self.folder)
        self.counts: Counter[str] = Counter()
        """Clips by status in this run, and as "kept" those of earlier runs."""
        self._most_tries = most_tries
        self._clips = {clip.name: clip for clip in clips}
        self._tries: dict[str, int] = {}
        self._finished: set[str] = set()
        self._read_manifest(retry_failed)
        self._count_interrupted()

    def tasks(self, clips_per_task: int) -> deque[Task]:
        """Returns the remaining clips in groups; clips with earlier attempts are alone."""
        tasks: deque[Task] = deque()
        alone: list[Task] = []
        group: Task = []
        size = 0
        for name, clip in self._clips.items():
            tries = self._tries.get(name, 0)
            if name in self._finished:
                continue
            if tries > 0:
                alone.append([(clip, tries)])
                continue
            if group and (len(group) >= clips_per_task or size + clip.bytes > _BYTES_PER_TASK):
                tasks.append(group)
                group, size = [], 0
            group.append((clip, 0))
            size += clip.bytes
        if group:
            tasks.append(group)
        # Run these last, so that a clip that ends the whole run does so after the others are done.
        tasks.extend(alone)
        return tasks

    def write_lists(self) -> int:
        """Writes passed.txt and failed.tsv (docs/batch.md) for the clips of this run.

        Returns:
            The number of lines in passed.txt.
        """
        self.manifest.flush()
        passed: list[str] = []
        failed = ["file\treason\trobot\n"]
        table = read_manifest(self.folder, ["status", "robot", "outputs", "message",
                                            "gates_missed"])
        for row in (row for batch in table.to_batches() for row in batch.to_pylist()):
            missed = ", ".join(row["gates_missed"] or [])
            if row["name"] not in self._clips:
                continue
            if row["status"] == "done" and not missed:
                passed.extend(file["file"] for file in row["outputs"]
                              if not file["file"].endswith(".contacts.csv"))
            else:
                reason = " ".join((missed or row["message"]).split())
                failed.append(f"{row['name']}\t{reason}\t{row['robot']}\n")
        _write_lines(self.folder / "passed.txt", (f"{file}\n" for file in sorted(passed)))
        _write_lines(self.folder / "failed.tsv", failed)
        return len(passed)

    def lost(self, task: Task) -> list[Task]:
        """Records that the process of a task ended; returns the tasks to repeat."""
        return self.record([new_row(self.request, clip, tries + 1) for clip, tries in task])

    def record(self, rows: list[dict[str, Any]]) -> list[Task]:
        """Adds rows to the manifest; returns the tasks to repeat: lost clips, each alone."""
        again = []
        for row in rows:
            if row["status"] == "lost" and row["tries"] >= self._most_tries:
                row["status"] = "failed"
                row["message"] += f" {row['tries']} times"
            if row["status"] == "lost":
                again.append([(self._clips[row["name"]], row["tries"])])
            else:
                self.counts[row["status"]] += 1
            self.manifest.add(row)
        if again:
            # The count of tries outlives this process.
            self.manifest.flush()
        return again

    def _read_manifest(self, retry_failed: bool) -> None:
        columns = ["name", "status", "tries", "options", "input_bytes", "input_version", "outputs"]
        for row in manifest_rows(self.folder, columns):
            name = row["name"]
            self._finished.discard(name)
            self._tries.pop(name, None)
            if not self._is_current(row):
                continue
            if row["status"] == "lost":
                self._tries[name] = row["tries"]
            elif row["status"] == "done" or not retry_failed:
                self._finished.add(name)
        self.counts["kept"] = len(self._finished)

    def _is_current(self, row: Mapping[str, Any]) -> bool:
        clip = self._clips.get(row["name"])
        if clip is None or row["options"] != self.request.fingerprint:
            return False
        if (row["input_bytes"], row["input_version"]) != (clip.bytes, clip.version):
            return False
        return all(self._has(file) for file in row["outputs"])

    def _has(self, file: Mapping[str, Any]) -> bool:
        try:
            return (self.folder / file["file"]).stat().st_size == file["bytes"]
        except OSError:
            return False

    def _count_interrupted(self) -> None:
        """Counts the tries of clips that were in progress when an earlier run was killed."""
        for work, names in interrupted(self.folder):
            left = [name for name in names if name in self._clips and name not in self._finished]
            again = self.lost([(self._clips[name], self._tries.get(name, 0)) for name in left])
            self._tries.update((clip.name, tries) for task in again for clip, tries in task)
            self._finished.update(set(left) - {clip.name for task in again for clip, _ in task})
            self.manifest.flush()
            shutil.rmtree(work, ignore_errors=True)


def _write_lines(file: Path, lines: Iterable[str]) -> None:
    with new_file(file) as unfinished:
        with unfinished.open("w", encoding="utf-8") as text:
            text.writelines(lines)
