"""Inputs, tasks and progress of large data sets, without a cluster."""

from __future__ import annotations

import io
import json
import os
import signal
import tarfile
import threading
import time
from pathlib import Path

import pytest

import retarget
from optional import need
from retarget.data_set.inputs import ClipSource, find_clips, place

CLIPS = ["squat.bvh", "sub/turn_in_place.bvh", "sub/wave.bvh"]


@pytest.fixture
def folder(data: Path, tmp_path: Path) -> Path:
    """Three clips, and two other files."""
    for name in CLIPS:
        file = tmp_path / "in" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes((data / Path(name).name).read_bytes())
    (tmp_path / "in/readme.txt").write_text("none")
    (tmp_path / "in/._squat.bvh").write_text("none")
    return tmp_path / "in"


@pytest.fixture
def tar(folder: Path, tmp_path: Path) -> Path:
    """The same clips in a tar, as WebDataset has them."""
    with tarfile.open(tmp_path / "clips.tar", "w") as file:
        for name in CLIPS:
            file.add(folder / name, name)
            text = b"{}"
            member = tarfile.TarInfo(name.replace(".bvh", ".json"))
            member.size = len(text)
            file.addfile(member, io.BytesIO(text))
    return tmp_path / "clips.tar"


def names(clips: list[ClipSource]) -> list[str]:
    return [clip.name for clip in clips]


def content(clip: ClipSource, folder: Path) -> bytes:
    place(clip, folder, None)
    return (folder / clip.name).read_bytes()


def test_folders_patterns_and_files(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert names(find_clips(folder)) == CLIPS
    assert names(find_clips([folder / "sub", folder / "squat.bvh"])) == [
        "squat.bvh", "turn_in_place.bvh", "wave.bvh"]
    assert names(find_clips(f"{folder}/s*/*.bvh")) == CLIPS[1:]
    assert names(find_clips(f"{folder}/**/w*.bvh")) == ["sub/wave.bvh"]
    monkeypatch.chdir(folder)
    assert names(find_clips("s*.bvh")) == ["squat.bvh"]


def test_tars(folder: Path, tar: Path, tmp_path: Path) -> None:
    clips = find_clips(tar)
    assert names(clips) == CLIPS
    for clip in clips:
        assert content(clip, tmp_path / "placed") == (folder / clip.name).read_bytes()
    (tmp_path / "shards").mkdir()
    tar.rename(tmp_path / "shards/0.tar")
    assert names(find_clips(tmp_path / "shards")) == CLIPS
    with (tmp_path / "shards/0.tar").open("r+b") as file:
        file.truncate(1000)
    with pytest.raises(retarget.InputError, match="0.tar"):
        find_clips(tmp_path / "shards")
    with pytest.raises(OSError, match="has changed"):
        content(ClipSource("a.bvh", str(tmp_path / "shards/0.tar"), 9000, "", 512), tmp_path)


def test_urls(folder: Path, tar: Path, tmp_path: Path) -> None:
    need("fsspec")
    for url in (f"file://{folder}", f"file://{folder}/**/*.bvh", f"file://{tar}"):
        clips = find_clips(url)
        # A pattern of fsspec does not hide names that begin with a dot.
        assert names(clips) == CLIPS
        assert all(clip.location.startswith("file://") and clip.version for clip in clips)
        for number, clip in enumerate(clips):
            placed = tmp_path / f"{len(url)}_{number}"
            assert content(clip, placed) == (folder / clip.name).read_bytes()
    with pytest.raises(retarget.InputError, match="nosuch"):
        find_clips("nosuch://clips/")


def test_bad_inputs(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(retarget.InputError, match="no such file"):
        find_clips(tmp_path / "none")
    (tmp_path / "empty").mkdir()
    with pytest.raises(retarget.InputError, match="no motion files"):
        find_clips([folder, tmp_path / "empty"])
    with pytest.raises(retarget.UsageError, match="same output"):
        find_clips([folder, folder / "squat.bvh"])
    with tarfile.open(tmp_path / "bad.tar", "w") as file:
        file.add(folder / "squat.bvh", "../squat.bvh")
    with pytest.raises(retarget.InputError, match="outside"):
        find_clips(tmp_path / "bad.tar")
    (folder / os.fsdecode(b"\xff.bvh")).write_text("")
    with pytest.raises(retarget.UsageError, match="UTF-8"):
        find_clips(folder)


# --- tasks ---


class Runs:
    """Runs data sets in this process."""

    def __init__(self, inputs: Path, out: Path) -> None:
        need("pyarrow")
        self.inputs, self.out = inputs, out

    def progress(self, *, robot: str = "unitree_g1", retry_failed: bool = False, **options):
        from retarget.data_set import run, solve

        request = solve.Request(str(self.out), robot, options, run.fingerprint(robot, options), {})
        return run.Progress(request, find_clips(self.inputs), 3, retry_failed)

    def __call__(self, **arguments) -> list[str]:
        """Solves all tasks; returns the names of their clips."""
        from retarget.data_set.solve import solve_clips

        progress = self.progress(**arguments)
        tasks, begun = progress.tasks(2), []
        while tasks:
            task = tasks.popleft()
            begun += [clip.name for clip, _ in task]
            tasks.extend(progress.record(solve_clips(progress.request, task, str(len(begun)))))
        progress.write_lists()
        return begun


@pytest.fixture
def runs(folder: Path, tmp_path: Path) -> Runs:
    return Runs(folder, tmp_path / "out")


def test_a_second_run_does_the_rest(runs: Runs, folder: Path, data: Path, tmp_path: Path) -> None:
    from retarget.data_set.manifest import read_manifest

    (folder / "broken.bvh").write_text("HIERARCHY\nROOT\n")
    assert runs() == ["broken.bvh", *CLIPS]
    retarget.batch(folder, tmp_path / "batch", "unitree_g1", jobs=1)
    for name in ("passed.txt", "squat.csv", "sub/wave.csv", "sub/turn_in_place.csv"):
        assert (runs.out / name).read_bytes() == (tmp_path / "batch" / name).read_bytes(), name
    rows = {row["name"]: row for row in read_manifest(runs.out).to_pylist()}
    assert rows["broken.bvh"]["status"] == "failed" and rows["broken.bvh"]["exit_code"] == 3
    lines = (tmp_path / "batch/manifest.jsonl").read_text().splitlines()
    for line in map(json.loads, lines):
        row = rows[line["relative"]]
        assert row["status"] == line["status"] and row["tries"] == 1
        assert [file["hash"] for file in row["outputs"]] == [
            file["hash"] for file in line["outputs"]]
        assert row["frames"] == line["frames"]
        if "quality" in line:
            assert dict(row["figures"]) == line["quality"]["figures"]

    assert runs() == []
    assert runs(retry_failed=True) == ["broken.bvh"]
    (runs.out / "sub/wave.csv").unlink()
    (folder / "squat.bvh").write_bytes((data / "walk.bvh").read_bytes())
    assert runs() == ["squat.bvh", "sub/wave.bvh"]
    assert runs(precision=4) == ["broken.bvh", *CLIPS]
    assert sorted(row["name"] for row in read_manifest(runs.out, ["status"]).to_pylist()) == [
        "broken.bvh", *CLIPS]
    assert not list((runs.out / ".work").iterdir())


def test_clips_in_a_killed_run_are_counted(runs: Runs) -> None:
    from retarget.data_set.manifest import read_manifest

    for number in range(3):
        work = runs.out / f".work/{number}"
        work.mkdir(parents=True)
        (work / "clips.json").write_text(json.dumps({"pid": 0, "clips": ["squat.bvh"]}))
        (runs.out / ".work/none").mkdir()
        progress = runs.progress()
        alone = [[clip.name for clip, _ in task] for task in progress.tasks(9)]
        assert alone == ([CLIPS[1:], ["squat.bvh"]] if number < 2 else [CLIPS[1:]])
    assert sorted(runs()) == CLIPS[1:]
    row = read_manifest(runs.out).to_pylist()[0]
    assert (row["name"], row["status"], row["tries"]) == ("squat.bvh", "failed", 3)
    assert row["message"] == "the clip's process ended 3 times"
    assert runs(retry_failed=True) == ["squat.bvh"]


def children(process: int) -> dict[int, bytes]:
    """Returns the command lines of the children of a process by their ids."""
    found = {}
    for task in Path(f"/proc/{process}/task").glob("*/children"):
        try:
            for child in map(int, task.read_text().split()):
                found[child] = Path(f"/proc/{child}/cmdline").read_bytes()
        except OSError:
            continue
    return found


def kill_first(find, done: threading.Event) -> None:
    """Kills the first process that find() returns, a moment after it began."""
    while not done.wait(0.002):
        for process in find():
            time.sleep(0.1)
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                continue
            return


@pytest.mark.parametrize("which", ["the solving process", "its worker"])
def test_a_killed_process_loses_only_tries(which: str, runs: Runs, folder: Path) -> None:
    from retarget.data_set.manifest import manifest_rows

    long = retarget.edit.loop(retarget.load(folder / "squat.bvh"), times=20)
    long.save(folder / "squat.bvh")

    def find() -> list[int]:
        workers = [child for child, command in children(os.getpid()).items()
                   if b"data_set.isolated" in command]
        if which == "its worker":
            return [worker for child in workers for worker in children(child)]
        return workers

    done = threading.Event()
    killer = threading.Thread(target=kill_first, args=(find, done))
    killer.start()
    try:
        begun = runs()
    finally:
        done.set()
        killer.join()
    assert sorted(set(begun)) == CLIPS and len(begun) > len(CLIPS)
    rows = list(manifest_rows(runs.out))
    assert {row["name"] for row in rows if row["status"] == "done"} == set(CLIPS)
    assert any(row["status"] == "lost" for row in rows)


def test_files_without_motion_fail(runs: Runs, folder: Path) -> None:
    import numpy as np

    from retarget.data_set.manifest import read_manifest

    np.savez(folder / "numbers.npz", numbers=np.zeros(3))
    (folder / "text.npy").write_text("none")
    assert sorted(runs()) == ["numbers.npz", *CLIPS, "text.npy"]
    for name in CLIPS:
        (folder / name).unlink()
    assert runs(retry_failed=True) == ["numbers.npz", "text.npy"]
    rows = {row["name"]: row for row in read_manifest(runs.out).to_pylist()}
    for name in ("numbers.npz", "text.npy"):
        assert (rows[name]["status"], rows[name]["exit_code"], rows[name]["tries"]) == (
            "failed", 3, 1), rows[name]["message"]


def test_wrong_options_stop_it(runs: Runs) -> None:
    with pytest.raises(retarget.UsageError, match="nosuch"):
        runs(nosuch=1)
    with pytest.raises(retarget.ConfigError):
        runs(robot="nosuch")


def test_packs_follow_the_motions(runs: Runs, folder: Path) -> None:
    from retarget.data_set.pack import pack_passed

    runs()
    pack = pack_passed(runs.out, "unitree_g1", "lerobot", {"max_clips": 1})
    files = sorted((pack / "data").rglob("*.parquet"))
    times = [file.stat().st_mtime_ns for file in files]
    pack_passed(runs.out, "unitree_g1", "lerobot", {"max_clips": 1})
    assert len(files) == 3 and times == [file.stat().st_mtime_ns for file in files]
    (folder / "sub/wave.bvh").unlink()
    runs()
    pack_passed(runs.out, "unitree_g1", "lerobot", {"max_clips": 2})
    assert len(list((pack / "data").rglob("*.parquet"))) == 1
    with pytest.raises(retarget.UsageError, match="pack: expected"):
        pack_passed(runs.out, "unitree_g1", "zip", {})
