"""verify, galleries and new robots: the files of the command."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

import retarget


@pytest.fixture(scope="module")
def batch(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The motions of two clips, with sidecars."""
    folder = tmp_path_factory.mktemp("batch")
    clips = [data / "wave.bvh", data / "squat.bvh"]
    retarget.batch(clips, folder / "out", "unitree_g1", jobs=1, sidecar=True)
    return folder / "out"


def test_verify_repeats_a_run(batch: Path, data: Path, command, tmp_path: Path) -> None:
    copy = Path(shutil.copytree(batch, tmp_path / "copy"))
    lines = retarget.verify(copy / "wave.csv.json")
    assert lines[-1] == "verified: wave.csv: the output and its report are identical"
    command("verify", copy / "wave.csv.json")
    (copy / "wave.csv").write_text("1\n")
    with pytest.raises(retarget.RunError, match="has changed since"):
        retarget.verify(copy / "wave.csv.json")
    with pytest.raises(retarget.InputError):
        retarget.verify(data / "wave.bvh")
    with pytest.raises(FileNotFoundError):
        retarget.verify(tmp_path / "none.json")


def test_a_gallery_has_the_command_s_pages(batch: Path, command, tmp_path: Path) -> None:
    index = retarget.gallery(batch, f"{tmp_path}/a/", gate="peak_speed<=2")
    command("view", batch, "-o", tmp_path / "b", "--gate", "peak_speed<=2")
    assert index == tmp_path / "a/index.html"
    pages = sorted(file.relative_to(tmp_path / "a") for file in (tmp_path / "a").rglob("*") if file.is_file())
    assert len(pages) >= 3
    for page in pages:
        assert (tmp_path / "a" / page).read_bytes() == (tmp_path / "b" / page).read_bytes(), page
    assert {"wave", "squat"} <= set(re.findall(r"\b(wave|squat)\b", index.read_text()))


def test_errors_of_galleries(batch: Path, data: Path, tmp_path: Path) -> None:
    with pytest.raises(retarget.InputError):
        retarget.gallery(data, tmp_path / "a")
    with pytest.raises(retarget.UsageError):
        retarget.gallery(batch, batch)
    with pytest.raises(TypeError, match="did you mean"):
        retarget.gallery(batch, f"{tmp_path}/a/", gates=[])
    with pytest.raises(retarget.UsageError, match=r"gallery\(\)"):
        retarget.view(batch)


def test_a_new_robot_is_the_command_s(command, g1: retarget.Robot, walk: retarget.Clip,
                                      tmp_path: Path) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    made = retarget.add_robot(g1.model, "mine", tmp_path / "a")
    command("robots", "add", "mine", "--model", g1.model, "-o", tmp_path / "b")
    assert made.folder == tmp_path / "a/mine" and made.summary
    files = sorted(file.name for file in made.folder.iterdir())
    assert "decisions.md" in files and "robot.json" in files
    for name in files:
        assert (made.folder / name).read_bytes() == (tmp_path / "b/mine" / name).read_bytes()
    robot = retarget.Robot(made.folder)
    assert len(robot.joint_names) == 29
    assert retarget.to_robot(walk, robot, frames="0:20", lead_in="keep").joint_positions.shape == (20, 29)
    with pytest.raises(retarget.UsageError):
        retarget.add_robot(g1.model, "mine", tmp_path / "a")
    assert retarget.add_robot(g1.model, "mine", tmp_path / "a", force=True).folder == made.folder


def test_errors_of_new_robots(data: Path, g1: retarget.Robot, tmp_path: Path) -> None:
    with pytest.raises(retarget.UsageError):
        retarget.add_robot(g1.model, "a/b", tmp_path)
    with pytest.raises(retarget.ConfigError):
        retarget.add_robot(data / "walk.bvh", "mine", tmp_path)
    with pytest.raises(retarget.UsageError, match="base"):
        retarget.add_robot(g1.model, "mine", tmp_path, base="floating")
    assert not list(tmp_path.iterdir())
