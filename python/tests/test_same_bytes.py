"""Python makes what the command makes, byte for byte."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import retarget

CLIPS = ["walk", "squat", "wave", "turn_in_place", "get_up"]
# Python keywords and the corresponding command-line words.
WAYS = {
    "fit": ({}, []),
    "gmr": ({"method": "gmr"}, ["--method", "gmr"]),
    "options": ({"fps": 50, "start": 0.5, "without": ["floor"], "limits": "gmr", "precision": 8,
                 "lead_in": "keep"},
                ["--fps", "50", "--start", "0.5", "--without", "floor", "--limits", "gmr",
                 "--precision", "8", "--lead-in", "keep"]),
    "variant": ({"dof": "23"}, ["--dof", "23"]),
}


@pytest.mark.parametrize("clip", CLIPS)
@pytest.mark.parametrize("way", WAYS)
def test_of_a_csv(clip: str, way: str, data: Path, tmp_path: Path, command) -> None:
    keywords, words = WAYS[way]
    retarget.to_robot(data / f"{clip}.bvh", "unitree_g1", **keywords).save(tmp_path / "python.csv")
    command(data / f"{clip}.bvh", "unitree_g1", "-o", tmp_path / "command.csv", *words)
    assert (tmp_path / "python.csv").read_bytes() == (tmp_path / "command.csv").read_bytes()


@pytest.mark.parametrize("name", ["npz-mjlab", "npz-beyondmimic", "npz-holosoma", "pkl-gmr",
                                  "pkl-pbhc", "pkl-motion-lib", "csv-soma", "glb"])
def test_of_every_format(name: str, walked: retarget.Motion, data: Path, tmp_path: Path,
                         command) -> None:
    ending = name.split("-")[0]
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    # Tracking formats have their own rate; the motion is solved at it if the format is given.
    own_rate = ending == "npz"
    motion = retarget.to_robot(data / "walk.bvh", "unitree_g1", format=name) if own_rate else walked
    motion.save(tmp_path / f"a/walk.{ending}", format=name)
    command(data / "walk.bvh", "unitree_g1", "-o", tmp_path / f"b/walk.{ending}", "--format", name)
    assert ((tmp_path / f"a/walk.{ending}").read_bytes()
            == (tmp_path / f"b/walk.{ending}").read_bytes())


def test_of_several_formats_and_columns(walked: retarget.Motion, data: Path, tmp_path: Path,
                                        command) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    walked.save(tmp_path / "a/walk.csv", format="csv,pkl-gmr", csv_header=True, csv_quat="wxyz",
                csv_delimiter="tab", csv_degrees=True, normalize_start=True)
    command(data / "walk.bvh", "g1", "-o", tmp_path / "b/walk.csv", "--format", "csv,pkl-gmr",
            "--csv-header", "--csv-quat", "wxyz", "--csv-delimiter", "tab", "--csv-degrees",
            "--normalize-start")
    made = {file.name: file.read_bytes() for file in (tmp_path / "a").iterdir()}
    assert made == {file.name: file.read_bytes() for file in (tmp_path / "b").iterdir()}
    assert len(made) == 2


def test_several_clips_at_once(data: Path, g1: retarget.Robot, tmp_path: Path) -> None:
    def make(number: int) -> bytes:
        clip = CLIPS[number % len(CLIPS)]
        file = tmp_path / f"{number}.csv"
        retarget.to_robot(data / f"{clip}.bvh", g1, threads=1 + number % 2).save(file)
        return file.read_bytes()

    alone = [make(number) for number in range(len(CLIPS))]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(make, range(2 * len(CLIPS))))
    assert together == alone + alone


def test_one_clip_in_several_threads(walk: retarget.Clip, g1: retarget.Robot) -> None:
    with ThreadPoolExecutor(4) as pool:
        made = list(pool.map(lambda _: retarget.to_robot(walk, g1, method="gmr").qpos.tobytes(),
                             range(8)))
    assert len(set(made)) == 1


def test_edits(data: Path, tmp_path: Path, walk: retarget.Clip, command) -> None:
    edits = {
        "mirror": (lambda: retarget.edit.mirror(walk), []),
        "turn": (lambda: retarget.edit.turn(walk, 30.0), ["30"]),
        "move": (lambda: retarget.edit.move(walk, 1.0, -0.5), ["1,-0.5"]),
        "ground": (lambda: retarget.edit.ground(walk), []),
        "lafan": (lambda: retarget.edit.lafan1(walk), []),
        "trim": (lambda: retarget.edit.trim(walk, frames=slice(10, 60)), ["--frames", "10:60"]),
        "resample": (lambda: retarget.edit.resample(walk, 50, speed=0.8),
                     ["--fps", "50", "--speed", "0.8"]),
        "loop": (lambda: retarget.edit.loop(walk, shortest=1.0, in_place=True),
                 ["--shortest", "1", "--in-place"]),
        "path": (lambda: retarget.edit.follow_path(walk, "circle", radius=4.0, keep="speed"),
                 ["--to", "circle", "--radius", "4", "--keep", "speed"]),
        "transfer": (lambda: retarget.edit.transfer(walk, retarget.load(data / "squat.bvh")),
                     ["--to", str(data / "squat.bvh")]),
        "rest": (lambda: retarget.edit.rest(walk, retarget.load(data / "squat.bvh")),
                 ["--like", str(data / "squat.bvh")]),
    }
    for name, (make, words) in edits.items():
        make().save(tmp_path / f"{name}_python.bvh")
        command("edit", name, data / "walk.bvh", *words, "-o", tmp_path / f"{name}_command.bvh")
        assert ((tmp_path / f"{name}_python.bvh").read_bytes()
                == (tmp_path / f"{name}_command.bvh").read_bytes()), name


def test_joined_clips(data: Path, tmp_path: Path, walk: retarget.Clip, command) -> None:
    mirrored = retarget.edit.mirror(walk)
    mirrored.save(tmp_path / "mirrored.bvh")
    command("edit", "concat", data / "walk.bvh", tmp_path / "mirrored.bvh", "-o",
            tmp_path / "command.bvh")
    joined = retarget.edit.concatenate([walk, retarget.load(tmp_path / "mirrored.bvh")])
    joined.save(tmp_path / "python.bvh")
    assert (tmp_path / "python.bvh").read_bytes() == (tmp_path / "command.bvh").read_bytes()


def test_trim_takes_slices_as_sequences_do(walk: retarget.Clip) -> None:
    frames = len(walk)
    for part in (slice(-10, None), slice(5, -5), slice(None, 7), slice(-frames - 5, 3)):
        assert len(retarget.edit.trim(walk, frames=part)) == len(range(frames)[part])
    last = retarget.edit.trim(walk, frames=slice(-10, None))
    assert (last.positions == walk.positions[-10:]).all()


def test_resample_without_a_low_pass(walk: retarget.Clip) -> None:
    plain = retarget.edit.resample(walk, 10, antialias=False)
    same = retarget.edit.resample(walk, 10, no_antialias=True)
    smooth = retarget.edit.resample(walk, 10, antialias=True)
    assert plain.positions.tobytes() == same.positions.tobytes()
    assert plain.positions.tobytes() != smooth.positions.tobytes()
