"""The examples of docs/python.md run, and the values in their comments are right."""

from __future__ import annotations

import json
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import retarget

PAGE = Path(__file__).resolve().parents[2] / "docs/python.md"
pytestmark = pytest.mark.skipif(not PAGE.is_file(), reason="the documentation is missing")

TABLE = {"bodies": [{"name": "table", "position": [2, 2, 0], "shapes": [
    {"type": "box", "size": [1.2, 0.6, 0.04], "position": [0, 0, 0.7]}]}]}


@pytest.mark.filterwarnings("ignore::retarget.RetargetWarning")
def test_examples(data: Path, walk: retarget.Clip, g1: retarget.Robot, walked: retarget.Motion,
                  tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("walk", "wave"):
        Path(f"{name}.bvh").write_bytes((data / f"{name}.bvh").read_bytes())
    walked.save("motion.pkl", format="pkl-gmr")
    Path("table.json").write_text(json.dumps(TABLE))
    Path("my_robots").mkdir()
    names = {"retarget": retarget, "ThreadPoolExecutor": ThreadPoolExecutor, "robot": g1,
             "files": ["walk.bvh", "wave.bvh"], "positions": walk.positions,
             "names": walk.joint_names}
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)
    # A block with an ellipsis in a list is a pattern and not a program.
    programs = [block for block in blocks if "...]" not in block]
    assert len(programs) >= 9
    for program in programs:
        names["clip"] = walk  # Some programs make another clip.
        exec(compile(program, str(PAGE), "exec"), names)
    motion = names["motion"]
    assert Path("gallery/index.html").exists()
    assert Path("again.csv").read_bytes() == Path("frames.csv").read_bytes() != b""
    assert Path("walk.html").stat().st_size > 100_000 and Path("both.bvh").exists()
    assert isinstance(motion, retarget.Motion) and motion.scene.positions.shape == (301, 1, 3)


def test_values_in_comments(walk: retarget.Clip, g1: retarget.Robot) -> None:
    plan = retarget.make_plan(walk, g1, fps=50)
    assert (plan.frame_count, plan.body_height) == (501, 1.75)
    motion = retarget.Motion.from_qpos(np.tile(g1.zero_configuration, (501, 1)), g1, 50)
    assert motion[10:200].resample(30).duration == pytest.approx(3.78, abs=0.02)
