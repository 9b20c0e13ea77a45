"""The examples run."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples/python"
pytestmark = pytest.mark.skipif(not EXAMPLES.is_dir(), reason="there are no examples here")


def run(name: str, *arguments: object) -> None:
    before = sys.argv
    sys.argv = [name, *map(str, arguments)]
    try:
        runpy.run_path(str(EXAMPLES / name), run_name="__main__")
    finally:
        sys.argv = before


def test_a_clip(data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run("01_clip_to_motion.py", data / "walk.bvh", "unitree_g1", tmp_path / "out")
    assert "all gates passed" in capsys.readouterr().out
    with np.load(tmp_path / "out/walk.npz") as file:
        assert file["joint_pos"].shape[1] == 29
    assert (tmp_path / "out/walk.csv").exists()


def test_a_folder(data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "clips").mkdir()
    for name in ("walk", "wave"):
        (tmp_path / f"clips/{name}.bvh").write_bytes((data / f"{name}.bvh").read_bytes())
    (tmp_path / "clips/broken.bvh").write_text("HIERARCHY\nROOT\n")
    run("02_folder.py", tmp_path / "clips", "unitree_g1", tmp_path / "out")
    printed = capsys.readouterr().out
    assert "broken.bvh:3:1" in printed and "walk.bvh: good" in printed and "1 failed" in printed
    assert len(list((tmp_path / "out").glob("*.npz"))) == 4


def test_a_live_loop(data: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run("03_live.py", data / "walk.bvh", "unitree_g1")
    assert "301 frames" in capsys.readouterr().out
