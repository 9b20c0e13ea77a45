"""LeRobot's data set format, version 3.0: Parquet files of frames, and metadata."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from retarget import _retarget
from retarget._errors import UsageError
from retarget.packs._clips import Clips, MotionReader, NamedMotion, StrPath
from retarget.packs._parquet import arrow, rows_of, write_table
from retarget.packs._parts import new_folder, parts
from retarget.packs._statistics import Statistics

VERSION = "v3.0"
FILES_PER_CHUNK = 1000
EPISODES_PER_FILE = 20_000
_FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_INDICES = ("frame_index", "episode_index", "index", "task_index")
_ROOT = ["root_x", "root_y", "root_z", "root_qw", "root_qx", "root_qy", "root_qz"]


@dataclass
class _Episode:
    """A clip as the columns of its frames."""

    name: str
    columns: dict[str, np.ndarray]
    """(F, N) float32 or (F,) values by feature."""
    task: str

    @property
    def length(self) -> int:
        return len(self.columns["index"])

    @property
    def data_bytes(self) -> int:
        return sum(column.nbytes for column in self.columns.values())


@dataclass
class _Totals:
    """Everything that the metadata of a data set needs to know about its episodes."""

    episodes: int = 0
    frames: int = 0
    tasks: dict[str, int] = field(default_factory=dict)
    """Indices by text, in order of appearance."""
    statistics: dict[str, Statistics] = field(default_factory=dict)


def write_lerobot(clips: Clips, folder: StrPath, *,
                  robot: _retarget.Robot | StrPath | None = None, fps: float | None = None,
                  task: str | Callable[[str], str] = "Track the reference motion.",
                  contacts: bool = False, max_bytes: int = 100 * 2**20, max_clips: int = 10_000,
                  replace: bool = False) -> Path:
    """Writes a data set that lerobot's LeRobotDataset loads (format v3.0), one episode per clip.

    Features, float32: `observation.state` (7 + N): root position x y z in metres in the world frame
    with z up, root quaternion w x y z (world_from_root), N joints in radians (slide joints: metres)
    in the order of Motion.joint_names. `action` (N): the joints of the next frame; the last frame
    repeats its own. `observation.contacts` (4), with `contacts`: 1 while a heel or toe is in
    contact, in the order of Motion.contact_names. The statistics do not include quantiles.

    Args:
        clips: motions by name; the name is the column `clip` of the episodes.
        folder: new folder of the data set.
        robot: robot of motion files, or an argument of Robot(); not needed for Motion objects.
        fps: frames per second that all motions must have, and rate of CSVs; None: the rate of the
            first motion. CSVs then have the rate of their sidecar, or that of the manifest for
            packs.clips_of(), or 30; `fps` must not contradict it.
        task: the text of all episodes, or a function of the clip's name.
        contacts: also write contacts; every motion must have them.
        max_bytes: largest size of a data file before compression, in bytes; a larger clip has its
            own file.
        max_clips: largest number of clips in a data file.
        replace: replace an earlier pack or an empty folder.

    Returns:
        The folder.

    Raises:
        UsageError: no clips, names out of order, motions of different joints or rates, a motion
            without contacts, bounds below 1, an existing folder.
        InputError: a file is not a motion of the robot.
        ConfigError: pyarrow is not installed, or the robot is unknown.
        RunError: a file could not be written.
    """
    arrow()
    reader = MotionReader(robot, fps)
    totals = _Totals()
    with new_folder(folder, replace) as unfinished:
        written = _write_data(unfinished, _episodes(reader, clips, task, contacts, totals),
                              max_bytes, max_clips)
        for number, rows in enumerate(parts(written, lambda _: 0, 1, EPISODES_PER_FILE)):
            _write_episodes(unfinished, number, rows)
        if totals.episodes == 0:
            raise UsageError("clips: expected at least one motion")
        _write_tasks(unfinished, list(totals.tasks))
        _write_json(unfinished / "meta/info.json", _info(reader, contacts, totals))
        _write_json(unfinished / "meta/stats.json", {
            feature: statistics.lists() for feature, statistics in totals.statistics.items()})
    return Path(folder)


def _episodes(reader: MotionReader, clips: Clips, task: str | Callable[[str], str],
              contacts: bool, totals: _Totals) -> Iterator[_Episode]:
    for clip in reader.motions(clips):
        text = task if isinstance(task, str) else task(clip.name)
        index = totals.tasks.setdefault(text, len(totals.tasks))
        columns = _state_columns(clip, contacts)
        length = len(clip.motion)
        frame = np.arange(length, dtype=np.int64)
        columns["timestamp"] = (frame / reader.fps).astype(np.float32)
        columns["frame_index"] = frame
        columns["episode_index"] = np.full(length, totals.episodes, dtype=np.int64)
        columns["index"] = frame + totals.frames
        columns["task_index"] = np.full(length, index, dtype=np.int64)
        totals.episodes += 1
        totals.frames += length
        for feature, values in columns.items():
            statistics = Statistics.of(values)
            if feature in totals.statistics:
                totals.statistics[feature].add(statistics)
            else:
                totals.statistics[feature] = statistics
        yield _Episode(clip.name, columns, text)


def _state_columns(clip: NamedMotion, contacts: bool) -> dict[str, np.ndarray]:
    motion = clip.motion
    joints = motion.joint_positions.astype(np.float32)
    root = np.hstack([motion.root_position, motion.root_rotation_wxyz]).astype(np.float32)
    columns = {"observation.state": np.hstack([root, joints])}
    if contacts:
        if motion.contacts is None:
            raise UsageError(f"clips[{clip.name!r}]: the motion has no contacts")
        columns["observation.contacts"] = motion.contacts.astype(np.float32)
    columns["action"] = np.vstack([joints[1:], joints[-1:]])
    return columns


def _chunk_and_file(number: int) -> tuple[int, int]:
    return divmod(number, FILES_PER_CHUNK)


def _path(kind: str, number: int) -> str:
    chunk, file = _chunk_and_file(number)
    return f"{kind}/{_FILE.format(chunk_index=chunk, file_index=file)}"


def _write_data(folder: Path, episodes: Iterator[_Episode], max_bytes: int,
                max_clips: int) -> Iterator[dict[str, Any]]:
    """Writes the data files, and yields the rows of their episodes."""
    pa = arrow()
    for number, part in enumerate(parts(episodes, lambda each: each.data_bytes, max_bytes,
                                        max_clips)):
        columns = {feature: rows_of(np.concatenate([each.columns[feature] for each in part]))
                   for feature in part[0].columns}
        # Streams of the first, second, ... bytes of all numbers compress a tenth better.
        write_table(pa.table(columns), folder / _path("data", number), use_byte_stream_split=True)
        for episode in part:
            yield _episode_row(episode, number)


def _episode_row(episode: _Episode, data_file: int) -> dict[str, Any]:
    chunk, file = _chunk_and_file(data_file)
    first = int(episode.columns["index"][0])
    row = {"episode_index": int(episode.columns["episode_index"][0]), "tasks": [episode.task],
           "length": episode.length, "clip": episode.name, "data/chunk_index": chunk,
           "data/file_index": file, "dataset_from_index": first,
           "dataset_to_index": first + episode.length}
    for feature, values in episode.columns.items():
        for key, numbers in Statistics.of(values).lists().items():
            row[f"stats/{feature}/{key}"] = numbers
    return row


def _write_episodes(folder: Path, number: int, rows: list[dict[str, Any]]) -> None:
    pa = arrow()
    chunk, file = _chunk_and_file(number)
    for row in rows:
        row["meta/episodes/chunk_index"] = chunk
        row["meta/episodes/file_index"] = file
    write_table(pa.Table.from_pylist(rows), folder / _path("meta/episodes", number),
                use_dictionary=["tasks.list.element"])


def _write_tasks(folder: Path, tasks: list[str]) -> None:
    """Writes the table of tasks. Its index for pandas is the text, as lerobot expects."""
    pa = arrow()
    table = pa.table({"task_index": pa.array(range(len(tasks)), pa.int64()),
                      "task": pa.array(tasks, pa.string())})
    of_pandas = {
        "index_columns": ["task"], "column_indexes": [],
        "columns": [
            {"name": name, "field_name": name, "pandas_type": kind, "numpy_type": numpy_type,
             "metadata": None}
            for name, kind, numpy_type in (("task_index", "int64", "int64"),
                                           ("task", "unicode", "object"))],
        "pandas_version": "2.0.0"}
    write_table(table.replace_schema_metadata({"pandas": json.dumps(of_pandas)}),
                folder / "meta/tasks.parquet")


def _info(reader: MotionReader, contacts: bool, totals: _Totals) -> dict[str, Any]:
    joints = list(reader.joint_names)
    vectors = {"observation.state": [*_ROOT, *joints], "action": joints}
    if contacts:
        vectors["observation.contacts"] = list(reader.contact_names)
    features: dict[str, Any] = {
        name: {"dtype": "float32", "shape": [len(names)], "names": names}
        for name, names in vectors.items()}
    features["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
    for name in _INDICES:
        features[name] = {"dtype": "int64", "shape": [1], "names": None}
    fps = float(reader.fps)
    return {
        "codebase_version": VERSION, "robot_type": reader.robot.name or None,
        "total_episodes": totals.episodes, "total_frames": totals.frames,
        "total_tasks": len(totals.tasks), "chunks_size": FILES_PER_CHUNK,
        "data_files_size_in_mb": 100, "video_files_size_in_mb": 200,
        "fps": int(fps) if fps.is_integer() else fps,
        "splits": {"train": f"0:{totals.episodes}"},
        "data_path": f"data/{_FILE}", "video_path": None, "features": features}


def _write_json(file: Path, data: dict[str, Any]) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(data, indent=4, ensure_ascii=False) + "\n", encoding="utf-8")
