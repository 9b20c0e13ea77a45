"""Reports have the figures of `retarget evaluate`."""

from __future__ import annotations

import collections
import json
import pickle
import types
import warnings
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


@pytest.mark.parametrize("words", ["--start 2 --end 6", "--mirror", "--time-scale auto",
                                   "--travel 0.8", "--frames 30:90 --method gmr"])
def test_a_file_is_measured_as_its_sidecar_records(words: str, data: Path, tmp_path: Path,
                                                   command) -> None:
    clip, file = data / "walk.bvh", tmp_path / "x.csv"
    command(clip, "unitree_g1", "-o", file, "--sidecar", *words.split())
    expected = evaluated(command, tmp_path, file, "--robot", "unitree_g1", "--bvh", clip)
    motion = retarget.load_motion(file, "unitree_g1")
    assert retarget.evaluate(motion, clip).data == expected
    # Without the record, the limbs are 2 to 20 degrees apart.
    whole = retarget.evaluate(motion[:], clip).figures
    assert whole["limb_angle_deg"] == expected["limb_angle_deg"][0]
    part = retarget.evaluate(motion[20:], clip).figures
    assert part["limb_angle_deg"] == pytest.approx(expected["limb_angle_deg"][0], abs=0.3)


@pytest.mark.parametrize("words, edit", [
    ("--mirror", retarget.edit.mirror),
    ("--start 2 --end 6", lambda clip: retarget.edit.trim(clip, start=2.0, end=6.0)),
], ids=["mirror", "trim"])
def test_an_edited_clip_is_not_edited_again(words: str, edit, data: Path, walk: retarget.Clip,
                                            tmp_path: Path, command) -> None:
    file = tmp_path / "x.csv"
    command(data / "walk.bvh", "unitree_g1", "-o", file, "--sidecar", *words.split())
    motion = retarget.load_motion(file, "unitree_g1")
    expected = retarget.evaluate(motion, walk).figures["limb_angle_deg"]
    with pytest.warns(retarget.RetargetWarning, match="not applied to an edited clip"):
        figures = retarget.evaluate(motion, edit(walk)).figures
    # Otherwise the limbs are 2 to 20 degrees apart.
    assert figures["limb_angle_deg"] == pytest.approx(expected, abs=1.0)


def test_options_that_are_none_are_not_given(data: Path, walk: retarget.Clip,
                                             walked: retarget.Motion, tmp_path: Path,
                                             command) -> None:
    expected = retarget.evaluate(walked[60:120], walk).json
    assert retarget.evaluate(walked[60:120], walk, start=None, frames=None).json == expected
    file = tmp_path / "x.csv"
    command(data / "walk.bvh", "unitree_g1", "-o", file, "--sidecar", "--start", "2", "--end", "6")
    motion = retarget.load_motion(file, "unitree_g1")
    both = retarget.evaluate(motion, data / "walk.bvh", start=2.0, end=6.0)
    assert retarget.evaluate(motion, data / "walk.bvh", end=6.0).figures == both.figures


@pytest.mark.parametrize("options", [
    {}, {"start": 2.0}, {"time_scale": "auto"}, {"time_scale": 0.5}, {"height": 1.3},
    {"travel": 0.8}, {"terrain": "stairs:0.15x0.3"}, {"method": "gmr", "scale": "height"},
], ids=str)
def test_a_part_is_measured_as_it_was_solved(options: dict, data: Path, walk: retarget.Clip,
                                             g1: retarget.Robot) -> None:
    motion = retarget.to_robot(walk, g1, **options)
    expected = retarget.evaluate(motion).figures
    names = ["limb_angle_deg", "track_pos_cm", "float_planted_pct", "stance_height_p50_cm"]
    # A file has six decimals.
    for same in (retarget.evaluate(motion, data / "walk.bvh"), retarget.evaluate(motion[:], walk)):
        for name in names:
            assert same.figures[name] == pytest.approx(expected[name], abs=2e-3), name
    half = len(motion) // 2
    parts = [retarget.evaluate(part, walk) for part in (motion[:half], motion[half:])]
    mean = sum(part.figures["limb_angle_deg"] for part in parts) / 2
    assert mean == pytest.approx(expected["limb_angle_deg"], abs=0.05)
    stored = retarget.evaluate(pickle.loads(pickle.dumps(motion[half:])), walk)
    assert stored.json == parts[1].json


def test_other_parts_and_rates_of_a_part(walk: retarget.Clip, walked: retarget.Motion) -> None:
    expected = retarget.evaluate(walked[60:120], walk).figures["limb_angle_deg"]
    given = retarget.evaluate(walked[60:120], walk, start=2.0)
    assert given.figures["limb_angle_deg"] == expected
    assert retarget.evaluate(walked[60:120], walk, frames="60:").figures == given.figures
    wrong = retarget.evaluate(walked[60:120], walk, start=0.0).figures["limb_angle_deg"]
    assert wrong > 2.0 * expected
    for other in (walked[60:].resample(50), walked.resample(50)[100:], walked[30:][30:]):
        again = retarget.evaluate(other, walk).figures["limb_angle_deg"]
        assert again == pytest.approx(expected, abs=0.3)


def test_frames_without_a_source_are_a_warning(walk: retarget.Clip,
                                               walked: retarget.Motion) -> None:
    short = retarget.edit.trim(walk, end=2.0)
    with pytest.warns(retarget.RetargetWarning, match="the source has 61 frames"):
        retarget.evaluate(walked, short)
    # A part ends before its source.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        retarget.evaluate(walked[10:50], walk)


def test_gates_that_no_motion_can_pass(walked: retarget.Motion) -> None:
    with pytest.raises(retarget.UsageError, match="peak_speed: expected a maximum"):
        retarget.evaluate(walked, gates={"peak_speed": float("nan")})
    with pytest.raises(retarget.UsageError, match="the minimum is above the maximum"):
        retarget.evaluate(walked, gates={"peak_speed": (3, 1)})


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
