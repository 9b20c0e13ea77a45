"""Reports have the figures of `retarget evaluate`."""

from __future__ import annotations

import collections
import json
import types
from pathlib import Path

import pytest

import retarget


def evaluated(command, tmp_path: Path, *words: object) -> dict:
    # A missed gate is a result, with its own exit code.
    try:
        command("evaluate", *words, "--json", tmp_path / "report.json")
    except AssertionError:
        assert (tmp_path / "report.json").exists()
    return json.loads((tmp_path / "report.json").read_text())["motions"][0]


@pytest.mark.parametrize("clip", ["walk", "get_up"])
def test_report_of_a_solved_motion(clip: str, data: Path, tmp_path: Path, command) -> None:
    motion = retarget.to_robot(data / f"{clip}.bvh", "unitree_g1")
    motion.save(tmp_path / f"{clip}.csv")
    expected = evaluated(command, tmp_path, tmp_path / f"{clip}.csv", "--robot", "unitree_g1",
                         "--bvh", data / f"{clip}.bvh")
    report = retarget.evaluate(motion)
    assert report.data["fit"]["terms"]
    # A file does not record whether its solver failed.
    of_run = ("fit", "file", "solver_failures")
    own = {key: value for key, value in report.data.items() if key not in of_run}
    own["gates"] = [gate for gate in own["gates"] if gate["metric"] not in of_run]
    assert own == {key: value for key, value in expected.items() if key != "file"}


def test_report_of_a_read_motion(data: Path, walk: retarget.Clip, walked: retarget.Motion, g1,
                          tmp_path: Path, command) -> None:
    for name, options in (("walk.csv", {}), ("walk.npz", {"format": "npz-mjlab"})):
        file = tmp_path / name
        walked.save(file, **options)
        motion = retarget.load_motion(file, g1)
        words = [file, "--robot", "unitree_g1"]
        assert retarget.evaluate(motion).data == evaluated(command, tmp_path, *words)
        beside = retarget.evaluate(motion, walk)
        assert beside.data == evaluated(command, tmp_path, *words, "--bvh", data / "walk.bvh")
        assert "limb_angle_deg" in beside.figures and "limb_angle_deg_p95" in beside.figures


def test_gates_and_faults(data: Path, walk: retarget.Clip, g1: retarget.Robot) -> None:
    motion = retarget.to_robot(walk, g1, method="gmr", limits="gmr")
    report = retarget.evaluate(motion, gates={"peak_speed": 0.1})
    assert not report.passed
    assert "peak_speed" in {gate["metric"] for gate in report.missed}
    assert retarget.evaluate(motion, gates=False).passed
    assert all(fault.begin <= fault.worst_frame < fault.end for fault in report.faults)
    assert report.faults and {fault.metric for fault in report.faults} <= set(report.data)
    text = str(report)
    assert "peak_speed" in text or "peak speed" in text
    with pytest.raises(retarget.UsageError, match='did you mean "peak_speed"'):
        retarget.evaluate(motion, gates={"peek_speed": 1.0})
    with pytest.raises(retarget.UsageError, match="expected a maximum"):
        retarget.evaluate(motion, gates={"peak_speed": "high"})


def test_inverse_dynamics(data: Path, walk: retarget.Clip, walked: retarget.Motion,
                          tmp_path: Path, command) -> None:
    assert "dynamics_bad_pct" not in retarget.evaluate(walked).figures
    report = retarget.evaluate(walked, dynamics=True)
    walked.save(tmp_path / "walk.csv")
    expected = evaluated(command, tmp_path, tmp_path / "walk.csv", "--robot", "unitree_g1",
                         "--bvh", data / "walk.bvh", "--dynamics")
    assert report.figures["dynamics_bad_pct"] == expected["dynamics_bad_pct"]


def test_the_metrics_are_explained() -> None:
    metrics = {key: definition for key, unit, definition in retarget.metrics()}
    assert "peak_speed" in metrics and all(metrics.values())


def test_inspect(data: Path, walk: retarget.Clip, command) -> None:
    expected = json.loads(command("inspect", data / "walk.bvh", "--json").stdout)
    found = retarget.inspect(walk).data
    assert {k: v for k, v in found.items() if k != "file"} == {
        k: v for k, v in expected.items() if k != "file"}
    assert "walk.bvh" in str(retarget.inspect(data / "walk.bvh"))


def test_what_was_solved_keeps_its_source(walk: retarget.Clip, g1: retarget.Robot) -> None:
    motion = retarget.to_robot(walk, g1, method="gmr", fps=50, start=1.0)
    whole = retarget.evaluate(motion)
    other = retarget.evaluate(motion, limits="official")
    assert set(other.figures) == set(whole.figures) and "limb_angle_deg" in other.figures
    assert other.data["limits"] == "official" != whole.data["limits"]
    assert other.figures["limb_angle_deg"] == whole.figures["limb_angle_deg"]
    for same in (retarget.evaluate(motion, motion.source), retarget.evaluate(motion, walk),
                 retarget.evaluate(motion, fps=50, start=1.0, limits=None)):
        assert same.data == whole.data
    assert whole.data["frames"] == len(motion) and whole.data["fps"] == 50.0
    for options in ({"fps": 30}, {"start": 0.5}, {"unit": "m"}, {"height": 1.5},
                    {"ik_config": "derived"}):
        with pytest.raises(retarget.UsageError, match="measured with the options of its run"):
            retarget.evaluate(motion, **options)


def test_what_was_solved_beside_another_clip(walk: retarget.Clip, g1: retarget.Robot) -> None:
    motion = retarget.to_robot(walk, g1, method="gmr", fps="source")
    again = retarget.edit.turn(retarget.edit.resample(walk, 60), 0.0)
    assert retarget.evaluate(motion, again).data["frames"] == len(motion)
    fast = retarget.to_robot(walk, g1, method="gmr", fps=60)
    assert retarget.evaluate(fast, again).data["fps"] == 60.0


def test_gates_of_any_mapping(walk: retarget.Clip, g1: retarget.Robot) -> None:
    motion = retarget.to_robot(walk, g1, method="gmr", end=1.0)
    expected = retarget.evaluate(motion, gates={"peak_speed": (None, 0.1)})
    for gates in (types.MappingProxyType({"peak_speed": [None, 0.1]}),
                  collections.ChainMap({"peak_speed": 0.1})):
        assert retarget.evaluate(motion, gates=gates).data == expected.data
    with pytest.raises(retarget.UsageError, match="unknown metric"):
        retarget.evaluate(motion, gates={"\udcff": 1.0})
    with pytest.raises(retarget.UsageError, match="gates: expected a string"):
        retarget.evaluate(motion, gates={7: 1.0})
