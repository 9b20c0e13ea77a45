"""Data sets on a local cluster of Ray: killed workers and removed machines change no byte."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import retarget
from optional import need

pytestmark = pytest.mark.skipif("LD_PRELOAD" in os.environ,
                                reason="Ray's own processes do not start with a sanitizer")

CLIPS = 200
POISON = "c1/walk_030.bvh"
# A driver outside this process. Ray stops its tasks when it ends.
DRIVER = """
import sys, retarget.ray, retarget.data_set.manifest as manifest
manifest._SECONDS = 0.2
retarget.ray.retarget_dataset(sys.argv[1], sys.argv[2], "unitree_g1", address=sys.argv[3],
                              clips_per_task=5)
"""


NODE = {"num_cpus": 2, "object_store_memory": 80 * 2**20, "include_dashboard": False}


@pytest.fixture(scope="module", autouse=True)
def cluster() -> Iterator:
    """Starts Ray with two workers; yields its cluster, to which nodes can be added."""
    ray = need("ray")
    need("pyarrow")
    from ray.cluster_utils import Cluster

    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    # The default is too short for a busy machine.
    os.environ["RAY_raylet_start_wait_time_s"] = "120"
    try:
        started = Cluster(initialize_head=True, head_node_args=NODE)
        ray.init(address=started.address, log_to_driver=False)
    except Exception as error:  # Ray raises many kinds, such as for a sandbox without shared memory.
        pytest.skip(f"Ray does not start on this machine: {error}")
    yield started
    ray.shutdown()
    started.shutdown()


@pytest.fixture(scope="module")
def clips(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Parts of the samples, turned."""
    folder = tmp_path_factory.mktemp("clips")
    samples = {name: retarget.load(data / f"{name}.bvh") for name in ("walk", "squat", "wave")}
    for number in range(CLIPS):
        name = list(samples)[number % 3]
        part = retarget.edit.trim(samples[name], frames=slice(number % 90, number % 90 + 20))
        file = folder / f"c{number % 2}/{name}_{number:03d}.bvh"
        file.parent.mkdir(exist_ok=True)
        retarget.edit.turn(part, 7.0 * number).save(file)
    (folder / "c0/walk_030.bvh").rename(folder / POISON)
    return folder


@pytest.fixture(scope="module")
def batch(clips: Path, command, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of `retarget batch`."""
    out = tmp_path_factory.mktemp("batch") / "out"
    command("batch", clips, "-o", out, "--robot", "unitree_g1", "--jobs", 2)
    return out


@pytest.fixture(scope="module")
def undisturbed(batch: Path) -> dict[str, bytes]:
    """The files of `retarget batch`."""
    made = motions(batch)
    assert len(made) == CLIPS
    return made


def motions(folder: Path) -> dict[str, bytes]:
    return {str(file.relative_to(folder)): file.read_bytes()
            for file in sorted(folder.rglob("*.csv")) if file.name != "summary.csv"}


def run(clips: Path | str, out: Path, **arguments):
    from retarget.ray import retarget_dataset

    return retarget_dataset(clips, out, **{"robot": "unitree_g1", "clips_per_task": 5, **arguments})


def statuses(out: Path) -> dict[str, tuple[str, int]]:
    from retarget.data_set import read_manifest

    return {row["name"]: (row["status"], row["tries"])
            for row in read_manifest(out, ["status", "tries"]).to_pylist()}


class Killer(threading.Thread):
    """Kills workers of Ray: some of them once, and each that begins the poison clip."""

    def __init__(self, out: Path) -> None:
        super().__init__(daemon=True)
        self.out, self.done = out, threading.Event()
        self.killed: set[Path] = set()
        self.with_poison = 0

    def run(self) -> None:
        while not self.done.wait(0.003):
            for file in self.out.glob(".work/*/clips.json"):
                self._look_at(file)

    def _look_at(self, file: Path) -> None:
        try:
            about = json.loads(file.read_text())
        except FileNotFoundError:
            return
        poison = POISON in about["clips"]
        if file in self.killed or not (poison or len(self.killed) < 5):
            return
        time.sleep(0.05)  # The worker's process has begun to solve.
        if kill_if_there(about["pid"]):
            self.killed.add(file)
            self.with_poison += poison


def test_killed_workers_change_no_byte(clips: Path, undisturbed: dict[str, bytes],
                                       tmp_path: Path) -> None:
    out = tmp_path / "out"
    killer = Killer(out)
    killer.start()
    try:
        made = run(clips, out)
    finally:
        killer.done.set()
        killer.join()
    assert len(killer.killed) >= 6 and killer.with_poison == 3, killer.killed
    assert (made.clips, made.done, made.failed, made.kept) == (CLIPS, CLIPS - 1, 1, 0)
    found = statuses(out)
    assert found.pop(POISON) == ("failed", 3)
    assert all(status == "done" and tries <= 2 for status, tries in found.values())
    assert any(tries == 2 for _, tries in found.values())
    poison = POISON.replace(".bvh", ".csv")
    assert motions(out) == {name: content for name, content in undisturbed.items()
                            if name != poison}
    assert poison not in (out / "passed.txt").read_text()
    assert "c1/walk_030.bvh\tthe clip's process ended 3 times" in (out / "failed.tsv").read_text()
    assert not list((out / ".work").iterdir())
    deadline = time.monotonic() + 20
    while processes_with(str(out)):
        assert time.monotonic() < deadline, processes_with(str(out))
        time.sleep(0.05)

    again = run(clips, out)
    assert (again.done, again.failed, again.kept) == (0, 0, CLIPS)
    healed = run(clips, out, retry_failed=True)
    assert (healed.done, healed.failed, healed.kept) == (1, 0, CLIPS - 1)
    assert motions(out) == undisturbed


def processes_with(text: str) -> list[str]:
    """Returns the command lines that contain a text."""
    found = []
    for file in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            line = file.read_bytes().decode(errors="replace")
        except OSError:
            continue
        if text in line:
            found.append(line)
    return found


class NodeKiller(threading.Thread):
    """Kills all processes of a node while one of its workers solves clips."""

    def __init__(self, cluster, node, out: Path) -> None:
        super().__init__(daemon=True)
        self.cluster, self.node, self.out = cluster, node, out
        self.done = threading.Event()
        self.in_progress = 0

    def run(self) -> None:
        raylet = next(each.process.pid for each in self.node.all_processes["raylet"])
        while not self.done.wait(0.003):
            workers = children_of(raylet)
            # The manifest shows that the run is not at its beginning.
            if not list((self.out / "manifest").glob("*")):
                continue
            self.in_progress = len(workers & set(self._pids()))
            if self.in_progress:
                self.cluster.remove_node(self.node, allow_graceful=False)
                for worker in workers:
                    kill_if_there(worker)
                return

    def _pids(self) -> Iterator[int]:
        for file in self.out.glob(".work/*/clips.json"):
            try:
                yield json.loads(file.read_text())["pid"]
            except FileNotFoundError:
                continue


def children_of(parent: int) -> set[int]:
    found = set()
    for file in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = file.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[1]) == parent:
            found.add(int(file.parent.name))
    return found


def kill_if_there(process: int) -> bool:
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True


def test_a_removed_node_changes_no_byte(clips: Path, undisturbed: dict[str, bytes], cluster,
                                        monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import ray
    from retarget.data_set import manifest

    monkeypatch.setattr(manifest, "_SECONDS", 0.2)
    node = cluster.add_node(**NODE)
    assert ray.cluster_resources()["CPU"] == 4
    killer = NodeKiller(cluster, node, tmp_path / "out")
    killer.start()
    try:
        made = run(clips, tmp_path / "out")
    finally:
        killer.done.set()
        killer.join()
    assert killer.in_progress > 0
    assert (made.done, made.failed, made.kept) == (CLIPS, 0, 0)
    tries = [tries for _, tries in statuses(tmp_path / "out").values()]
    assert 1 <= tries.count(2) <= 30 and max(tries) == 2
    assert motions(tmp_path / "out") == undisturbed
    # Ray notices a lost node after a while.
    deadline = time.monotonic() + 60
    while ray.cluster_resources()["CPU"] != 2:
        assert time.monotonic() < deadline
        time.sleep(0.1)


def test_a_killed_driver_is_continued(clips: Path, undisturbed: dict[str, bytes], cluster,
                                      tmp_path: Path) -> None:
    out = tmp_path / "out"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-c", DRIVER, clips, out, cluster.address]
    with subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL) as driver:
        deadline = time.monotonic() + 60
        while len(list((out / "manifest").glob("*"))) < 2:
            assert driver.poll() is None and time.monotonic() < deadline
            time.sleep(0.01)
        driver.kill()
    made = run(clips, out)
    assert 0 < made.kept < CLIPS and made.kept + made.done == CLIPS and made.failed == 0
    assert motions(out) == undisturbed


def test_tars_become_packs(clips: Path, batch: Path, undisturbed: dict[str, bytes],
                           tmp_path: Path) -> None:
    from retarget import packs

    files = {str(file.relative_to(clips).with_suffix("")): file
             for file in clips.rglob("*.bvh")}
    packs.write_webdataset(files, tmp_path / "shards", max_clips=70)
    made = run(f"{tmp_path}/shards/*.tar", tmp_path / "out", pack="webdataset",
               pack_options={"max_clips": 70})
    assert made.done == CLIPS
    passed, wanted = (sorted((out / "passed.txt").read_text().splitlines())
                      for out in (tmp_path / "out", batch))
    # A few excerpts begin with a contact of four frames, in which a foot slips by half a millimetre.
    assert made.passed == len(passed) >= CLIPS - 4
    assert passed == wanted
    assert motions(tmp_path / "out") == undisturbed
    assert len(list((tmp_path / "out/webdataset").glob("*.tar"))) == 3


def test_packs_read_csvs_in_the_units_of_the_call(data: Path, tmp_path: Path) -> None:
    import pyarrow.parquet as parquet

    clip = data / "wave.bvh"
    states = []
    for out, units in (("a", {}), ("b", {"csv_quat": "wxyz", "csv_degrees": True})):
        run([clip], tmp_path / out, method="gmr", quality=False, pack="lerobot", **units)
        table = parquet.read_table(next((tmp_path / out / "lerobot/data").rglob("*.parquet")))
        states.append(table["observation.state"].to_pylist())
    assert len(states[0]) == len(states[1])
    for one, other in zip(*states):
        assert one == pytest.approx(other, abs=1e-5)


def test_no_clip_lies_in_the_folder_of_its_pack(data: Path, tmp_path: Path) -> None:
    (tmp_path / "in/lerobot").mkdir(parents=True)
    (tmp_path / "in/lerobot/wave.bvh").write_bytes((data / "wave.bvh").read_bytes())
    with pytest.raises(retarget.UsageError, match="folder of the pack"):
        run(tmp_path / "in", tmp_path / "out", pack="lerobot")


def test_a_foreign_file_in_the_folder_of_the_pack_is_found_first(data: Path, tmp_path: Path) -> None:
    (tmp_path / "out/lerobot").mkdir(parents=True)
    (tmp_path / "out/lerobot/notes.txt").write_text("mine")
    with pytest.raises(retarget.UsageError, match='"notes.txt" in it is not of a pack'):
        run(data / "wave.bvh", tmp_path / "out", pack="lerobot")
    assert [file.name for file in (tmp_path / "out").iterdir()] == ["lerobot"]


def test_errors(clips: Path, tmp_path: Path) -> None:
    with pytest.raises(retarget.UsageError, match="jobs is not an option"):
        run(clips, tmp_path / "out", jobs=2)
    with pytest.raises(retarget.UsageError, match="nosuch"):
        run(clips, tmp_path / "out", nosuch=2)
    with pytest.raises(retarget.ConfigError):
        run(clips, tmp_path / "out", robot="nosuch")
    from retarget.data_set.run import locked

    with locked(tmp_path / "out"), pytest.raises(retarget.RunError, match="another process"):
        run(clips, tmp_path / "out")
