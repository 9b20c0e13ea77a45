"""Data sets in the formats of other libraries, loaded by these libraries if they are installed."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tarfile
import time
from pathlib import Path

import numpy as np
import pytest

import retarget
from optional import need
from retarget import packs

Clips = dict[str, retarget.Motion]


@pytest.fixture(scope="module")
def clips(data: Path, g1: retarget.Robot) -> Clips:
    """Nine motions of 20 to 60 frames, two of them in subfolders."""
    made = {}
    for number, name in enumerate(["walk", "squat", "wave"]):
        clip = retarget.load(data / f"{name}.bvh")
        for part in range(3):
            frames = slice(10 * part, 10 * part + 20 + 20 * number)
            folder = "sub/" if part == 1 else ""
            made[f"{folder}{name}_{part}"] = retarget.to_robot(
                retarget.edit.trim(clip, frames=frames), g1, lead_in="keep")
    return made


@pytest.fixture
def files(clips: Clips, tmp_path: Path) -> dict[str, Path]:
    """The motions as CSV files."""
    made = {}
    for name, motion in clips.items():
        made[name] = tmp_path / f"files/{name}.csv"
        made[name].parent.mkdir(parents=True, exist_ok=True)
        motion.save(made[name])
    return made


def hashes(folder: Path) -> dict[str, str]:
    return {str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest()
            for file in sorted(folder.rglob("*")) if file.is_file()}


def writer(kind: str):
    if kind != "webdataset":
        need("pyarrow")
    return getattr(packs, f"write_{kind}")


@pytest.mark.parametrize("kind", ["lerobot", "motion_v1", "webdataset"])
def test_same_clips_same_bytes(kind: str, clips: Clips, tmp_path: Path) -> None:
    write = writer(kind)
    write(clips, tmp_path / "a", max_clips=4)
    time.sleep(1.1)  # Times in files would otherwise have the same second.
    write(sorted(clips.items()), tmp_path / "b", max_clips=4)
    assert hashes(tmp_path / "a") == hashes(tmp_path / "b")
    assert not [file for file in tmp_path.iterdir() if file.name.startswith(".")]


@pytest.mark.parametrize("kind", ["lerobot", "motion_v1", "webdataset"])
def test_an_existing_folder_is_replaced_only_on_request(kind: str, clips: Clips,
                                                        tmp_path: Path) -> None:
    write = writer(kind)
    (tmp_path / "set").mkdir()
    (tmp_path / "set/mine.txt").write_text("mine")
    with pytest.raises(retarget.UsageError, match="exists"):
        write(clips, tmp_path / "set")
    assert (tmp_path / "set/mine.txt").read_text() == "mine"
    with pytest.raises(retarget.UsageError, match="mine.txt"):
        write(clips, tmp_path / "set", replace=True)
    assert (tmp_path / "set/mine.txt").read_text() == "mine"
    (tmp_path / "set/mine.txt").unlink()
    write(clips, tmp_path / "set", replace=True)
    earlier = hashes(tmp_path / "set")
    write(clips, tmp_path / "set", replace=True)
    assert hashes(tmp_path / "set") == earlier


def test_a_pack_replaces_no_batch(data: Path, tmp_path: Path) -> None:
    out = batch_of_wave(data, tmp_path)
    found = packs.clips_of(out)
    before = hashes(tmp_path)
    for folder in (out, tmp_path):
        with pytest.raises(retarget.UsageError, match="not of a pack"):
            packs.write_webdataset(found, folder, replace=True)
    assert hashes(tmp_path) == before


@pytest.mark.parametrize("kind", ["lerobot", "motion_v1", "webdataset"])
def test_a_failure_leaves_nothing(kind: str, clips: Clips, tmp_path: Path) -> None:
    def failing():
        yield from sorted(clips.items())[:5]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        writer(kind)(failing(), tmp_path / "set", max_clips=2)
    assert list(tmp_path.iterdir()) == []


def test_a_killed_writer_leaves_no_data_set(tmp_path: Path) -> None:
    (tmp_path / "clip.csv").write_text("0\n" * 1000)
    program = (
        "import sys, time; from retarget import packs\n"
        "def clips():\n"
        "    for number in range(1000):\n"
        "        yield f'{number:04d}', sys.argv[1]\n"
        "        if number == 9: print('begun', flush=True)\n"
        "        if number > 9: time.sleep(0.05)\n"
        "packs.write_webdataset(clips(), sys.argv[2], max_clips=2)\n")
    with subprocess.Popen([sys.executable, "-c", program, tmp_path / "clip.csv", tmp_path / "set"],
                          stdout=subprocess.PIPE, text=True) as writer:
        assert writer.stdout is not None and writer.stdout.readline() == "begun\n"
        os.kill(writer.pid, signal.SIGKILL)
    assert not (tmp_path / "set").exists()
    packs.write_webdataset({"a": tmp_path / "clip.csv"}, tmp_path / "set")
    assert sorted(each.name for each in tmp_path.iterdir()) == ["clip.csv", "set"]


@pytest.mark.parametrize("clips, message", [
    ([("b", "x.csv"), ("a", "x.csv")], "ascending"),
    ([("a", "x.csv"), ("a", "x.csv")], "ascending"),
    ([("../a", "x.csv")], "names such as"), ([("/a", "x.csv")], "names such as"),
    ([(1, "x.csv")], "names such as"),
    ({"a.b": "x.csv", "a_b": "x.csv"}, "same key"),
    ({"__a__/walk": "x.csv"}, "skip '__a__/walk'"),
])
def test_bad_names(clips, message: str, tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("0\n")
    pairs = clips.items() if isinstance(clips, dict) else clips
    with pytest.raises(retarget.UsageError, match=message):
        packs.write_webdataset([(name, tmp_path / file) for name, file in pairs], tmp_path / "set")
    with pytest.raises(retarget.UsageError, match="max_bytes"):
        packs.write_webdataset({"a": tmp_path / "x.csv"}, tmp_path / "set", max_bytes=0)
    with pytest.raises(retarget.RunError, match="No such file"):
        packs.write_webdataset({"a": tmp_path / "none.csv"}, tmp_path / "set")


def test_motions_must_agree(clips: Clips, files: dict[str, Path], tmp_path: Path) -> None:
    need("pyarrow")
    motion = clips["walk_0"]
    with pytest.raises(retarget.UsageError, match="50 frames per second, expected 30"):
        packs.write_lerobot({"a": motion, "b": retarget.to_robot(motion.source, motion.robot,
                                                                fps=50)}, tmp_path / "set")
    with pytest.raises(retarget.UsageError, match="joints differ"):
        packs.write_lerobot({"a": motion, "b": retarget.to_robot(motion.source, "g1", dof="23")},
                            tmp_path / "set")
    with pytest.raises(retarget.UsageError, match="robot: needed"):
        packs.write_lerobot(files, tmp_path / "set")
    with pytest.raises(retarget.UsageError, match="no contacts"):
        packs.write_lerobot(files, tmp_path / "set", robot="g1", contacts=True)
    with pytest.raises(retarget.UsageError, match="at least one"):
        packs.write_lerobot({}, tmp_path / "set")
    with pytest.raises(retarget.UsageError, match="no body 'tail'"):
        packs.write_motion_v1(clips, tmp_path / "set", end_effectors=["tail"])
    with pytest.raises(retarget.UsageError, match="two names become"):
        packs.write_motion_v1({"a/b": motion, "a__b": motion}, tmp_path / "set")
    with pytest.raises(retarget.UsageError, match="two names become"):
        packs.write_motion_v1({"a/b": motion, "a__b": motion}, tmp_path / "set", max_clips=1)


def test_passed_motions_of_a_batch(data: Path, tmp_path: Path) -> None:
    (tmp_path / "in/sub").mkdir(parents=True)
    for name in ("wave", "sub/squat"):
        (tmp_path / f"in/{name}.bvh").write_bytes((data / f"{Path(name).name}.bvh").read_bytes())
    retarget.batch(tmp_path / "in", tmp_path / "out", "g1", format="csv,npz-mjlab", jobs=1)
    found = packs.clips_of(tmp_path / "out", ".mjlab.npz")
    assert found == {name: tmp_path / f"out/{name}.mjlab.npz" for name in ("sub/squat", "wave")}
    shards = packs.write_webdataset(found, tmp_path / "set")
    assert [shard.name for shard in shards] == ["shard-000000.tar"]
    with pytest.raises(retarget.InputError, match="passed.txt"):
        packs.clips_of(tmp_path / "in")

    from retarget.packs.__main__ import main

    words = ["webdataset", str(tmp_path / "out"), str(tmp_path / "again"), "--ending", ".mjlab.npz"]
    assert main(words) == 0
    assert hashes(tmp_path / "again") == hashes(tmp_path / "set")
    assert main(words) == 1 and main([*words, "--replace"]) == 0
    assert main([*words, "--replace", "--robot", "g1"]) == 0
    with pytest.raises(SystemExit):
        main([*words, "--fps", "30"])


def batch_of_wave(data: Path, tmp_path: Path, robots="g1", **options) -> Path:
    (tmp_path / "in").mkdir()
    (tmp_path / "in/wave.bvh").write_bytes((data / "wave.bvh").read_bytes())
    retarget.batch(tmp_path / "in", tmp_path / "out", robots, end=0.5, quality=False, **options)
    return tmp_path / "out"


def test_two_formats_need_an_ending(data: Path, tmp_path: Path) -> None:
    out = batch_of_wave(data, tmp_path, format="csv,pkl-gmr")
    with pytest.raises(retarget.UsageError, match=r'same clip; ending="\.gmr\.pkl"'):
        packs.clips_of(out)
    assert packs.clips_of(out, ".csv") == {"wave": out / "wave.csv"}


def test_the_robot_is_that_of_the_batch(data: Path, tmp_path: Path) -> None:
    need("pyarrow")
    # A robot with as many joints.
    found = packs.clips_of(batch_of_wave(data, tmp_path, "agibot_x2"))
    with pytest.raises(retarget.UsageError, match="records a motion of agibot_x2, but robot is"):
        packs.write_lerobot(found, tmp_path / "set", robot="unitree_h2")
    packs.write_lerobot(found, tmp_path / "set", robot="agibot_x2")


def test_a_batch_of_several_robots_is_packed_by_robot(data: Path, tmp_path: Path,
                                                      capsys: pytest.CaptureFixture) -> None:
    need("pyarrow")
    out = batch_of_wave(data, tmp_path, ["unitree_g1", "unitree_h1"], method="gmr")
    from retarget.packs.__main__ import main

    assert main(["lerobot", str(out), str(tmp_path / "set"), "--robot", "g1"]) == 0
    assert "left out 1 motion of other robots: unitree_h1" in capsys.readouterr().err
    assert main(["webdataset", str(out), str(tmp_path / "tars")]) == 1
    assert "motions of unitree_g1, unitree_h1; --robot takes" in capsys.readouterr().err
    assert main(["webdataset", str(out), str(tmp_path / "tars"), "--robot", "g1"]) == 0
    with tarfile.open(tmp_path / "tars/shard-000000.tar") as tar:
        assert {name.partition("/")[0] for name in tar.getnames()} == {"unitree_g1"}
    found = packs.clips_of(out, robot="unitree_h1")
    assert list(found) == ["unitree_h1/wave"] and list(found.left_out) == ["unitree_g1/wave"]
    with pytest.raises(retarget.UsageError, match="no motion of agibot_x2; its robots are unitree_"):
        packs.clips_of(out, robot="agibot_x2")


def test_a_robot_of_a_folder_is_that_of_the_batch(data: Path, tmp_path: Path,
                                                   g1: retarget.Robot) -> None:
    need("pyarrow")
    folder = tmp_path / "robots/mine"
    shutil.copytree(Path(g1.model).parent, folder)
    found = packs.clips_of(batch_of_wave(data, tmp_path, str(folder)))
    packs.write_lerobot(found, tmp_path / "set", robot=folder)


def test_names_without_a_common_ending(tmp_path: Path) -> None:
    (tmp_path / "passed.txt").write_text("wave.csv\n")
    line = {"outputs": [{"file": "wave.csv"}, {"file": "talk"}]}
    (tmp_path / "manifest.jsonl").write_text(json.dumps(line) + "\n")
    assert list(packs.clips_of(tmp_path)) == ["wave"]
    (tmp_path / "passed.txt").write_text("wave.csv\ntalk\n")
    with pytest.raises(retarget.UsageError, match="same clip; give an ending"):
        packs.clips_of(tmp_path)


@pytest.mark.parametrize("options, expected", [
    ({}, {"source_angles": "rad", "source_unit": "m", "source_quat": "xyzw"}),
    ({"csv_quat": "wxyz", "csv_degrees": True},
     {"source_angles": "deg", "source_unit": "m", "source_quat": "wxyz"}),
    ({"csv_header": True}, {"source_angles": "rad", "source_unit": "m"}),
], ids=str)
def test_units_are_those_that_the_batch_records(options: dict, expected: dict, data: Path,
                                                tmp_path: Path) -> None:
    found = packs.clips_of(batch_of_wave(data, tmp_path, **options))
    assert found.csv_units == {"wave": expected}


def test_csvs_have_the_units_of_their_batch(data: Path, tmp_path: Path) -> None:
    need("pyarrow")
    out = batch_of_wave(data, tmp_path, csv_degrees=True, csv_centimetres=True)
    made = packs.write_lerobot(packs.clips_of(out), tmp_path / "set", robot="g1")
    largest = json.loads((made / "meta/stats.json").read_text())["observation.state"]["max"]
    assert 0.7 < largest[2] < 0.9 and max(largest[7:]) < 3.0


@pytest.mark.parametrize("kind", ["csv", "pkl-gmr"])
@pytest.mark.parametrize("variant", ["23", "23-pbhc"])
def test_the_joints_are_those_of_the_recorded_variant(variant: str, kind: str, data: Path,
                                                      tmp_path: Path) -> None:
    need("pyarrow")
    found = packs.clips_of(batch_of_wave(data, tmp_path, dof=variant, format=kind))
    made = packs.write_lerobot(found, tmp_path / "set", robot="g1")
    features = json.loads((made / "meta/info.json").read_text())["features"]
    joints = retarget.Robot("g1", dof=variant).joint_names
    assert features["action"]["names"] == joints and len(joints) == 23
    # A Robot keeps its joints.
    made = packs.write_lerobot(found, tmp_path / "whole", robot=retarget.Robot("g1"))
    features = json.loads((made / "meta/info.json").read_text())["features"]
    assert features["action"]["shape"] == [29]


@pytest.mark.parametrize("kind", ["lerobot", "motion_v1"])
def test_a_clip_that_changes_after_its_hash_is_an_error(kind: str, data: Path, tmp_path: Path,
                                                        monkeypatch: pytest.MonkeyPatch) -> None:
    found = packs.clips_of(batch_of_wave(data, tmp_path))
    load = retarget.load_motion

    def replace_and_load(file: Path, *args: object, **options: object) -> retarget.Motion:
        text = file.read_text().split("\n")
        file.write_text("\n".join(text[:10]) + "\n")
        return load(file, *args, **options)

    monkeypatch.setattr(retarget, "load_motion", replace_and_load)
    with pytest.raises(retarget.InputError, match=r"wave\.csv: changed while it was read"):
        writer(kind)(found, tmp_path / "set", robot="g1")
    assert not (tmp_path / "set").exists()


def test_a_clip_that_is_copied_while_it_is_read_is_unchanged(data: Path, tmp_path: Path,
                                                            monkeypatch: pytest.MonkeyPatch) -> None:
    need("pyarrow")
    found = packs.clips_of(batch_of_wave(data, tmp_path))
    load = retarget.load_motion

    def copy_and_load(file: Path, *args: object, **options: object) -> retarget.Motion:
        copy = file.with_suffix(".new")
        copy.write_bytes(file.read_bytes())
        copy.replace(file)
        return load(file, *args, **options)

    monkeypatch.setattr(retarget, "load_motion", copy_and_load)
    assert packs.write_lerobot(found, tmp_path / "set", robot="g1").is_dir()


@pytest.mark.parametrize("kind", ["lerobot", "motion_v1", "webdataset"])
def test_a_changed_clip_is_an_error(kind: str, data: Path, tmp_path: Path) -> None:
    write = writer(kind)
    robot = {} if kind == "webdataset" else {"robot": "g1"}
    found = packs.clips_of(batch_of_wave(data, tmp_path))
    text = found["wave"].read_text().split("\n")
    found["wave"].write_text("\n".join(text[:10]) + "\n")
    with pytest.raises(retarget.InputError, match=r"wave\.csv: has changed since the batch"):
        write(found, tmp_path / "set", **robot)
    write(dict(found), tmp_path / "set", **robot)


def test_end_effectors_of_the_command(data: Path, tmp_path: Path) -> None:
    need("pyarrow")
    from retarget.packs.__main__ import main

    words = ["motion_v1", str(batch_of_wave(data, tmp_path, "unitree_h1")), str(tmp_path / "set")]
    assert main([*words, "--robot", "unitree_h1"]) == 1
    hands = ["left_elbow_link", "right_elbow_link"]
    assert main([*words, "--robot", "unitree_h1", "--end-effectors", *hands]) == 0
    import pyarrow.parquet as parquet

    file = next((tmp_path / "set").rglob("*.parquet"))
    assert parquet.ParquetFile(file).read()["ee_link_names"].to_pylist() == [hands]


@pytest.mark.parametrize("kind", ["lerobot", "motion_v1"])
def test_a_missing_clip_is_named(kind: str, data: Path, tmp_path: Path) -> None:
    write = writer(kind)
    found = packs.clips_of(batch_of_wave(data, tmp_path))
    found["wave"].unlink()
    with pytest.raises(FileNotFoundError, match=r"wave\.csv") as caught:
        write(found, tmp_path / "set", robot="g1")
    assert caught.value.filename == str(found["wave"])


def test_csvs_have_the_rate_of_their_batch(data: Path, tmp_path: Path) -> None:
    need("pyarrow")
    (tmp_path / "in").mkdir()
    (tmp_path / "in/wave.bvh").write_bytes((data / "wave.bvh").read_bytes())
    retarget.batch(tmp_path / "in", tmp_path / "out", "g1", method="gmr", end=0.5, fps=60,
                   quality=False)
    found = packs.clips_of(tmp_path / "out")
    made = packs.write_lerobot(found, tmp_path / "set", robot="g1")
    assert json.loads((made / "meta/info.json").read_text())["fps"] == 60
    packs.write_lerobot(found, tmp_path / "set", robot="g1", fps=60, replace=True)
    # `fps` does not replace the recorded rate, and mixed rates are an error.
    contradiction = "60 frames per second recorded, but fps is 30; omit fps"
    with pytest.raises(retarget.UsageError, match=contradiction):
        packs.write_lerobot(found, tmp_path / "other", robot="g1", fps=30)
    files = dict(found)
    Path(f"{found['wave']}.json").write_text('{"found": {"fps": 60.0}}')
    with pytest.raises(retarget.UsageError, match=contradiction):
        packs.write_motion_v1(files, tmp_path / "other", robot="g1", fps=30)
    Path(f"{found['wave']}.json").unlink()
    found["zero"] = found["wave"]
    found.csv_rates["zero"] = 50.0
    with pytest.raises(retarget.UsageError, match="50 frames per second, expected 60"):
        packs.write_motion_v1(found, tmp_path / "mixed", robot="g1")


# --- LeRobot ---


@pytest.fixture(scope="module")
def lerobot_set(clips: Clips, tmp_path_factory: pytest.TempPathFactory) -> Path:
    need("pyarrow")
    return packs.write_lerobot(clips, tmp_path_factory.mktemp("lerobot") / "set", contacts=True,
                               task=lambda name: "wave" if "wave" in name else "move",
                               max_bytes=40_000, max_clips=2)


def test_schema_of_lerobot(lerobot_set: Path, clips: Clips) -> None:
    import pyarrow as pa
    import pyarrow.parquet as parquet

    info = json.loads((lerobot_set / "meta/info.json").read_text())
    frames = sum(map(len, clips.values()))
    assert (info["codebase_version"], info["robot_type"], info["fps"]) == ("v3.0", "unitree_g1", 30)
    assert (info["total_episodes"], info["total_frames"], info["total_tasks"]) == (9, frames, 2)
    assert info["features"]["observation.state"]["shape"] == [36]
    assert info["features"]["action"]["names"] == clips["walk_0"].joint_names

    data = sorted((lerobot_set / "data").rglob("*.parquet"))
    assert len(data) >= 5 and all(file.stat().st_size <= 40_000 for file in data)
    table = pa.concat_tables(parquet.read_table(file) for file in data)
    assert set(table.column_names) == set(info["features"])
    assert table["observation.state"].type == pa.list_(pa.float32(), 36)
    assert table["index"].to_pylist() == list(range(frames))

    episodes = parquet.read_table(lerobot_set / "meta/episodes/chunk-000/file-000.parquet")
    assert episodes["clip"].to_pylist() == sorted(clips)
    for row in episodes.to_pylist():
        motion = clips[row["clip"]]
        rows = table.slice(row["dataset_from_index"], row["length"])
        state = np.array(rows["observation.state"].to_pylist(), dtype=np.float32)
        expected = np.hstack([motion.root_position, motion.root_rotation_wxyz,
                              motion.joint_positions]).astype(np.float32)
        assert (state == expected).all()
        action = np.array(rows["action"].to_pylist(), dtype=np.float32)
        assert (action[:-1] == state[1:, 7:]).all() and (action[-1] == state[-1, 7:]).all()
        contacts = np.array(rows["observation.contacts"].to_pylist())
        assert (contacts == motion.contacts).all()
        assert np.allclose(row["stats/observation.state/std"], expected.std(axis=0), atol=1e-6)
        file = data[row["data/chunk_index"] * 1000 + row["data/file_index"]]
        assert row["episode_index"] in parquet.read_table(file)["episode_index"].to_pylist()


def test_statistics_of_lerobot(lerobot_set: Path, clips: Clips) -> None:
    stats = json.loads((lerobot_set / "meta/stats.json").read_text())
    joints = np.vstack([clips[name].joint_positions for name in sorted(clips)]).astype(np.float32)
    state = {key: np.array(value) for key, value in stats["observation.state"].items()}
    assert state["count"] == [len(joints)]
    assert (state["min"][7:] == joints.min(axis=0)).all()
    assert (state["max"][7:] == joints.max(axis=0)).all()
    assert np.allclose(state["mean"][7:], joints.mean(axis=0, dtype=float), atol=1e-12)
    assert np.allclose(state["std"][7:], joints.std(axis=0, dtype=float), atol=1e-12)


def test_files_and_motions_give_the_same_state(clips: Clips, files: dict[str, Path],
                                               tmp_path: Path) -> None:
    parquet = need("pyarrow.parquet")
    packs.write_lerobot(clips, tmp_path / "of_motions")
    packs.write_lerobot(files, tmp_path / "of_files", robot="unitree_g1")
    of_motions, of_files = (
        np.array(parquet.read_table(tmp_path / name / "data")["observation.state"].to_pylist())
        for name in ("of_motions", "of_files"))
    assert np.abs(of_motions - of_files).max() < 1e-6
    packs.write_lerobot(files, tmp_path / "faster", robot="unitree_g1", fps=60)
    assert json.loads((tmp_path / "faster/meta/info.json").read_text())["fps"] == 60


def test_lerobot_loads_it(lerobot_set: Path, clips: Clips,
                          monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    monkeypatch.setenv("HF_HOME", str(tmp_path))
    # It needs torch, which is too large for the tests' dependencies.
    datasets = need("lerobot.datasets.lerobot_dataset", installed_by_setup=False)
    whole = datasets.LeRobotDataset("local/motions", root=lerobot_set)
    assert (whole.num_episodes, whole.fps) == (9, 30)
    assert len(whole) == sum(map(len, clips.values()))
    first = clips[sorted(clips)[0]]
    assert np.allclose(whole[0]["observation.state"][7:], first.joint_positions[0], atol=1e-6)
    assert {whole[0]["task"], whole[len(whole) - 1]["task"]} == {"wave", "move"}
    window = datasets.LeRobotDataset("local/motions", root=lerobot_set, episodes=[2, 4],
                                     delta_timestamps={"action": [0.0, 1 / 30]})
    assert tuple(window[5]["action"].shape) == (2, 29)


# --- motion_v1 ---


def test_schema_of_motion_v1(clips: Clips, g1: retarget.Robot, tmp_path: Path) -> None:
    parquet = need("pyarrow.parquet")
    packs.write_motion_v1(clips, tmp_path / "set", max_clips=4, source_dataset="samples")
    parts = sorted((tmp_path / "set").iterdir())
    assert [part.name for part in parts] == ["part-000000", "part-000001", "part-000002"]
    motion = clips["sub/walk_1"]
    file = (tmp_path / "set/part-000000/sequence_id=sub__walk_1/robot_name=unitree_g1/data.parquet")
    row = parquet.ParquetFile(file).read().to_pylist()
    assert len(row) == 1
    values = row[0]
    assert (values["schema_version"], values["motion_kind"]) == ("motion_v1", "single_robot")
    assert (values["fps"], values["source_dataset"]) == (30.0, "samples")
    assert values["robot_joint_names"] == motion.joint_names
    assert np.allclose(values["robot_root_position"], motion.root_position, atol=1e-6)
    assert np.allclose(values["robot_root_wxyz"], motion.root_rotation_wxyz, atol=1e-6)
    assert np.allclose(values["robot_joint_positions"], motion.joint_positions, atol=1e-6)
    assert values["ee_link_names"] == ["left_wrist_yaw_link", "right_wrist_yaw_link"]
    poses = np.array(values["ee_pose_w"])
    wrist = g1.body_names.index("right_wrist_yaw_link")
    positions, rotations = g1.forward_kinematics(motion.qpos[-1])
    assert poses.shape == (len(motion), 2, 7)
    assert np.allclose(poses[-1, 1], [*positions[wrist], *rotations[wrist]], atol=1e-6)
    assert values["object_body_names"] == [] and values["hand_sides"] == []
    # The values in the path are not in the file: pyarrow adds them as columns.
    table = parquet.read_table(parts[0])
    assert table["robot_name"].to_pylist() == ["unitree_g1"] * 4
    assert len(parquet.ParquetFile(file).schema_arrow.names) == 42


# --- WebDataset ---


def test_webdataset_loads_the_same_bytes(files: dict[str, Path], tmp_path: Path) -> None:
    webdataset = need("webdataset")
    sizes = sorted(file.stat().st_size for file in files.values())
    bound = 3 * sizes[-1]
    shards = packs.write_webdataset(files, tmp_path / "set", max_bytes=bound,
                                    info=lambda name: {"words": name.split("_")[0]})
    assert len(shards) > 2 and all(shard.stat().st_size <= bound for shard in shards)
    loaded = list(webdataset.WebDataset([str(shard) for shard in shards], shardshuffle=False))
    assert [sample["__key__"] for sample in loaded] == sorted(files)
    for sample in loaded:
        assert sample["csv"] == files[sample["__key__"]].read_bytes()
        assert json.loads(sample["json"])["words"] == sample["__key__"].split("_")[0]


def test_keys_and_endings(clips: Clips, files: dict[str, Path], tmp_path: Path) -> None:
    import tarfile

    long = "/".join(["folder with a long name"] * 8)
    given = {"a.b": clips["walk_0"], f"{long}/ü": files["walk_0"]}
    packs.write_webdataset(given, tmp_path / "set", format="npz-mjlab")
    with tarfile.open(tmp_path / "set/shard-000000.tar") as tar:
        assert tar.getnames() == ["a_b.npz", "a_b.json", f"{long}/ü.csv", f"{long}/ü.json"]
        assert tar.extractfile("a_b.json").read() == b'{"name": "a.b"}'
        clips["walk_0"].save(tmp_path / "walk.npz", format="npz-mjlab")
        assert tar.extractfile("a_b.npz").read() == (tmp_path / "walk.npz").read_bytes()
        assert all((each.mtime, each.uid, each.uname) == (0, 0, "") for each in tar)
