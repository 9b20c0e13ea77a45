"""Data sets of any size on a Ray cluster.

    import retarget.ray

    retarget.ray.retarget_dataset("s3://bucket/clips/", "/shared/out", "unitree_g1",
                                  address="auto", format="npz-mjlab")

A few clips at a time are a task of Ray. A task solves its clips in a separate process, as
`retarget batch` does and with the same bytes, and moves the files into the output folder, which all
machines must see under the same path. The same call continues an interrupted one.
Needs ray and pyarrow; URLs need fsspec.
"""

from __future__ import annotations

import os
import shutil
import uuid
from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

from retarget._errors import ConfigError, RunError, UsageError
from retarget.data_set.inputs import StrPath, find_clips
from retarget.data_set.manifest import read_manifest
from retarget.data_set.pack import pack_passed
from retarget.data_set.run import Progress, Task, fingerprint, locked
from retarget.data_set.solve import WORK, Request, solve_clips
from retarget.packs._parquet import arrow
from retarget.packs._parts import check_target

__all__ = ["DataSet", "read_manifest", "retarget_dataset"]

# They select clips or write lists of a whole batch; a task sees only its own clips.
_OF_WHOLE_BATCHES = frozenset({
    "clips", "data_dir", "dedupe", "exclude", "jobs", "list", "mirror", "motion_list", "pack",
    "quiet", "redo", "relative_to", "resume", "shard", "sidecar", "split"})


@dataclass(frozen=True)
class DataSet:
    """Result of retarget_dataset()."""

    folder: Path
    clips: int
    """Number of clips of the inputs."""
    done: int
    """Clips that this call solved."""
    failed: int
    """Clips that failed in this call, including those whose process died in every attempt."""
    kept: int
    """Clips that an earlier call finished."""
    passed: int
    """Motions in passed.txt, of all calls."""


def retarget_dataset(inputs: StrPath | Iterable[StrPath], out: StrPath, robot: StrPath, *,
                     pack: Literal["lerobot", "motion_v1", "webdataset"] | None = None,
                     pack_options: Mapping[str, Any] | None = None, address: str | None = None,
                     clips_per_task: int = 16, most_tries: int = 3, retry_failed: bool = False,
                     tasks_in_flight: int | None = None,
                     storage_options: Mapping[str, Any] | None = None,
                     **options: Any) -> DataSet:
    """Retargets clips on Ray, with the same bytes as `retarget batch`.

    Errors of single clips do not stop it; the manifest records them (read_manifest()). A clip whose
    process ends is tried again, alone, and fails after `most_tries`. So does a clip whose worker or
    machine ends; tries are counted across calls, even if this process is killed. Ctrl-C leaves a
    folder that the same call continues.

    Args:
        inputs: folders, patterns, URLs and tar files (data_set.find_clips()).
        out: output folder: a local folder, or one that all machines share.
        robot: name or folder of the robot, on every machine.
        pack: afterwards also write the passed motions to the folder `out`/`pack` in this format
            (retarget.packs), if they have changed since the last call.
        pack_options: keyword arguments of the writer: max_bytes, max_clips, ...; for several
            formats per clip also `ending` of packs.clips_of().
        address: of a running cluster, "auto" to find it; None: the cluster that this process is
            connected to, otherwise processes on this machine.
        clips_per_task: largest number of clips of a task, which uses one processor.
        most_tries: times that a clip is begun before it fails.
        retry_failed: try clips again that failed in an earlier call.
        tasks_in_flight: tasks given to Ray at a time; None: four per processor of the cluster. An
            autoscaling cluster grows with it.
        storage_options: options of fsspec for URLs.
        options: options of retarget.batch() that concern single clips: format, fps, quality, ...;
            files that they name need the same absolute path on all machines.

    Raises:
        UsageError: an option of whole batches, two clips with one output, a wrong value.
        InputError: an input without motion files.
        ConfigError: an unknown robot, or ray or pyarrow is not installed.
        RunError: another process writes to the folder, or it cannot be written.
    """
    for name in sorted(_OF_WHOLE_BATCHES & options.keys()):
        raise UsageError(f"{name} is not an option of retarget_dataset()")
    for name, value in (("clips_per_task", clips_per_task), ("most_tries", most_tries)):
        if value < 1:
            raise UsageError(f"{name}: expected at least 1, found {value}")
    arrow()
    ray = _ray()
    folder = Path(os.path.abspath(out))
    robot = os.fspath(robot)
    clips = find_clips(inputs, storage_options)
    inside = [clip.name for clip in clips if pack is not None and clip.name.startswith(f"{pack}/")]
    if inside:
        raise UsageError(f'pack: the motion of "{inside[0]}" would lie in the folder of the pack; '
                         "rename the clip's folder")
    if pack is not None:
        check_target(folder / pack, replace=True)
    request = Request(str(folder), robot, options, fingerprint(robot, options),
                      dict(storage_options or {}))
    with locked(folder):
        progress = Progress(request, clips, most_tries, retry_failed)
        tasks = progress.tasks(clips_per_task)
        if tasks:
            if not ray.is_initialized():
                ray.init(address=address)
            _run(ray, progress, tasks, tasks_in_flight)
        passed = progress.write_lists()
        if pack is not None:
            pack_passed(folder, robot, pack, pack_options or {}, options)
    counts = progress.counts
    return DataSet(folder, len(clips), counts["done"], counts["failed"], counts["kept"], passed)


def _ray() -> ModuleType:
    try:
        import ray
    except ImportError as error:
        raise ConfigError(f"retarget_dataset() needs ray (pip install ray): {error}") from error
    return ray


def _run(ray: ModuleType, progress: Progress, tasks: deque[Task],
         tasks_in_flight: int | None) -> None:
    """Runs tasks until all clips are finished."""
    # Lost tasks are counted and repeated here, not by Ray.
    remote = ray.remote(num_cpus=1, max_retries=0)(solve_clips)
    request = ray.put(progress.request)
    running: dict[Any, tuple[Task, str]] = {}
    try:
        while tasks or running:
            most = tasks_in_flight or 4 * max(1, int(ray.cluster_resources().get("CPU", 1)))
            while tasks and len(running) < most:
                task, work = tasks.popleft(), uuid.uuid4().hex
                running[remote.remote(request, task, work)] = (task, work)
            ended, _ = ray.wait(list(running), num_returns=1, timeout=1.0)
            progress.manifest.flush_if_due()
            for reference in ended:
                task, work = running.pop(reference)
                tasks.extend(_result(ray, progress, reference, task, work))
    finally:
        for reference in running:
            ray.cancel(reference, force=True)
        # A worker may still have written when its lost task's folder was removed.
        for work in (progress.folder / WORK).glob("*/"):
            shutil.rmtree(work, ignore_errors=True)
        progress.manifest.flush()


def _result(ray: ModuleType, progress: Progress, reference: Any, task: Task,
            work: str) -> list[Task]:
    """Records an ended task; returns the tasks to repeat."""
    try:
        rows = ray.get(reference)
    except ray.exceptions.RayTaskError as error:
        # The task itself raised: the request is wrong, or the folder cannot be written.
        if isinstance(error.cause, OSError):
            raise RunError(f"{progress.folder}: {error.cause}") from error
        raise error.cause if isinstance(error.cause, Exception) else error
    except ray.exceptions.RayError:
        shutil.rmtree(progress.folder / WORK / work, ignore_errors=True)
        return progress.lost(task)
    return progress.record(rows)
