"""Invalid input raises a clear exception, never crashes and changes no state."""

from __future__ import annotations

import collections
import gc
import json
import os
import pathlib
import subprocess
import sys
import textwrap

import numpy as np
import pytest
from gmr_support import make_retargeter, sample_frames

import retarget
from retarget.gmr import GeneralMotionRetargeting
from retarget.gmr.params import IK_CONFIG_DICT, use_published_files

NAN = float("nan")


class _Awkward:
    def __len__(self) -> int:
        return 2

    def __getitem__(self, index: int):
        raise RuntimeError("no")


class _Array:
    def __array__(self, *args, **kwargs):
        raise RuntimeError("not an array either")


BAD_POSES = {
    "too short": ([0.0, 0.0], [1.0, 0.0, 0.0, 0.0]),
    "too long": ([0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]),
    "swapped": ([1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
    "a matrix": (np.zeros((1, 3)), [1.0, 0.0, 0.0, 0.0]),
    "a rotation matrix": ([0.0, 0.0, 1.0], np.eye(3)),
    "NaN": ([NAN, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]),
    "NaN in an array": (np.array([0.0, NAN, 0.0]), [1.0, 0.0, 0.0, 0.0]),
    "NaN in a quaternion": ([0.0, 0.0, 0.0], np.array([1.0, NAN, 0.0, 0.0])),
    "infinity": ([0.0, 0.0, float("inf")], [1.0, 0.0, 0.0, 0.0]),
    "zeros": ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]),
    "nearly zeros": ([0.0, 0.0, 0.0], [1e-200, 0.0, 0.0, 0.0]),
    "huge": ([0.0, 0.0, 0.0], [1e300, 1e300, 0.0, 0.0]),
    "texts": (["0", "0", "0"], [1.0, 0.0, 0.0, 0.0]),
    "text": ("abc", "abcd"),
    "bytes": (b"abc", b"abcd"),
    "a short text": "ab",
    "complex": (np.array([1j, 0, 0]), [1.0, 0.0, 0.0, 0.0]),
    "flags": (np.array([True, False, True]), [1.0, 0.0, 0.0, 0.0]),
    "objects": (np.array([None, 1, 2], dtype=object), [1.0, 0.0, 0.0, 0.0]),
    "ragged": ([[0.0], [0.0, 1.0], 2.0], [1.0, 0.0, 0.0, 0.0]),
    "none": None,
    "none inside": (None, None),
    "a number": 1.0,
    "one part": ([0.0, 0.0, 0.0],),
    "three parts": ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], 1),
    "a dictionary": {"position": [0.0, 0.0, 0.0], "rotation": [1.0, 0.0, 0.0, 0.0]},
    "a set": {1, 2},
    "raises": _Awkward(),
    "arrays that raise": (_Array(), _Array()),
    "empty": ([], []),
}


@pytest.mark.parametrize("pose", BAD_POSES.values(), ids=BAD_POSES.keys())
def test_a_bad_pose_names_its_body(pose) -> None:
    frames = sample_frames("walk", 2)
    retargeter = make_retargeter()
    before = retargeter.retarget(frames[0])
    error = retargeter.error2()
    with pytest.raises(ValueError, match="LeftHand"):
        retargeter.retarget(frames[1] | {"LeftHand": pose})
    np.testing.assert_array_equal(retargeter.qpos, before)
    assert retargeter.error2() == error
    expected = make_retargeter()
    expected.retarget(frames[0])
    np.testing.assert_array_equal(retargeter.retarget(frames[1]), expected.retarget(frames[1]))


def test_missing_bodies_are_all_named() -> None:
    frame = sample_frames("walk", 1)[0]
    for name in ("Hips", "LeftHand"):
        del frame[name]
    with pytest.raises(KeyError) as caught:
        make_retargeter().retarget(frame)
    assert isinstance(caught.value, retarget.Error)
    assert 'the bodies "Hips", "LeftHand" of ' in str(caught.value)
    with pytest.raises(KeyError, match="it is empty"):
        make_retargeter().retarget({})


@pytest.mark.parametrize("data", [None, 1, "walk", b"walk", [1, 2], np.zeros((14, 7)), object(),
                                  sample_frames])
def test_frames_must_be_dictionaries(data) -> None:
    with pytest.raises(ValueError, match="expected {body: "):
        make_retargeter().retarget(data)


@pytest.mark.parametrize("change", [("max_iter", 3), ("damping", 0.1)], ids=str)
def test_a_change_of_the_solver_keeps_the_targets(change: tuple[str, float]) -> None:
    frames = sample_frames("walk", 2)
    retargeter = make_retargeter()
    retargeter.retarget(frames[0])
    retargeter.update_targets(frames[1], offset_to_ground=True)
    targets, error = retargeter.scaled_human_data, retargeter.error1()
    setattr(retargeter, *change)
    np.testing.assert_equal(retargeter.scaled_human_data, targets)
    assert retargeter.error1() == error


def test_unknown_engine(tmp_path: pathlib.Path) -> None:
    given = make_retargeter()
    config = pathlib.Path(IK_CONFIG_DICT["bvh"]["unitree_g1"])
    with pytest.raises(ValueError, match='engine: expected "fast" or "reference"'):
        retarget._retarget.FrameRetargeter(
            model=given.xml_file, profile="", config=config.read_text(), config_file=str(config),
            damping=0.5, max_extra_steps=10, engine="fats")


SHARED = """
    import sys, threading
    import numpy as np
    from gmr_support import make_retargeter, sample_frames

    sys.setswitchinterval(1e-6)
    frame = sample_frames("walk", 1)[0]
    retargeter = make_retargeter()

    def use(number):
        for _ in range(200):
            for call in (retargeter.error1, lambda: setattr(retargeter, "qpos", np.zeros(36)),
                         lambda: retargeter.update_targets(frame | {"Hips": None})):
                try:
                    call()
                except ValueError:
                    pass
            retargeter.qpos

    threads = [threading.Thread(target=use, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
"""


def test_errors_in_several_threads_do_not_wait_for_each_other() -> None:
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(
        [str(pathlib.Path(__file__).parent), *filter(None, sys.path)])}
    subprocess.run([sys.executable, "-c", textwrap.dedent(SHARED)], check=True, timeout=120,
                   env=environment)


def test_other_mappings_are_taken() -> None:
    frame = sample_frames("walk", 1)[0]
    expected = make_retargeter().retarget(frame)
    for mapping in (collections.OrderedDict(frame), collections.ChainMap({}, frame),
                    collections.UserDict(frame)):
        np.testing.assert_array_equal(make_retargeter().retarget(mapping), expected)

    class Raises(collections.UserDict):
        def __getitem__(self, key):
            raise RuntimeError("mine")

    with pytest.raises(RuntimeError, match="mine"):
        make_retargeter().retarget(Raises(frame))


def test_positions_too_large_to_compute_with() -> None:
    frame = sample_frames("walk", 1)[0]
    retargeter = make_retargeter()
    before = retargeter.qpos
    far = {name: ([1e200, 0.0, 0.0], rotation) for name, (_, rotation) in frame.items()}
    with pytest.raises(ValueError, match="too large"):
        retargeter.retarget(far)
    np.testing.assert_array_equal(retargeter.qpos, before)


@pytest.mark.parametrize("offset", ["x", None, NAN, float("inf"), [0.1]])
def test_the_ground_offset_is_a_finite_number(offset) -> None:
    retargeter = make_retargeter()
    with pytest.raises(ValueError, match="ground_offset: expected a finite number"):
        retargeter.set_ground_offset(offset)
    assert retargeter.ground_offset == 0.0
    retargeter.set_ground_offset(np.float32(0.25))


@pytest.mark.parametrize("qpos", [None, "x", [], np.zeros(36), np.zeros(35), np.full(36, NAN),
                                  np.zeros((36, 1)), ["1"] * 36])
def test_bad_configurations(qpos) -> None:
    retargeter = make_retargeter()
    before = retargeter.qpos
    with pytest.raises(ValueError):
        retargeter.qpos = qpos
    np.testing.assert_array_equal(retargeter.qpos, before)


@pytest.mark.parametrize("changes, expected", [
    ({"tgt_robot": "unitree_g2"}, "did you mean 'unitree_g1'"),
    ({"src_human": "bvh_lafan"}, "did you mean 'bvh_lafan1'"),
    ({"tgt_robot": "unitree_h1"}, "for 'unitree_h1', only for unitree_g1.*ik_config accepts a file"),
    ({"src_human": "fbx_offline"}, "no tables of 'fbx_offline' for 'unitree_g1'; ik_config"),
    ({"actual_human_height": 0.0}, "expected metres"),
    ({"actual_human_height": -1.7}, "expected metres"),
    ({"actual_human_height": NAN}, "expected metres"),
    ({"actual_human_height": "tall"}, "expected metres"),
    ({"damping": 0.0}, "damping"),
    ({"damping": NAN}, "damping"),
])
def test_bad_arguments_of_the_constructor(changes, expected) -> None:
    with pytest.raises(ValueError, match=expected):
        make_retargeter(**changes)


def test_bad_names_are_key_errors_too() -> None:
    with pytest.raises(KeyError):
        make_retargeter(tgt_robot="unitree_g2")
    with pytest.raises((TypeError, KeyError)):
        make_retargeter(tgt_robot=["unitree_g1"])


def _tables() -> dict:
    return json.loads(pathlib.Path(IK_CONFIG_DICT["bvh_lafan1"]["unitree_g1"]).read_text())


@pytest.mark.parametrize("fault, expected", [
    (lambda t: t.pop("human_scale_table"), "human_scale_table"),
    (lambda t: t.update(ground_height="low"), "ground_height"),
    (lambda t: t.update(human_height_assumption=0), "expected metres"),
    (lambda t: t["human_scale_table"].update(Hips="x"), "numbers"),
    (lambda t: t["human_scale_table"].pop("Hips"), "no entry in"),
    (lambda t: t["ik_match_table1"].update(pelvis=["Hips"]), "must be"),
    (lambda t: t["ik_match_table1"].update(pelvsi=t["ik_match_table1"].pop("pelvis")),
     "did you mean"),
    (lambda t: t.update(robot_initial_qpos={"knee": 1.0}), "not a joint of the robot"),
    (lambda t: t.update(robot_initial_qpos={"left_knee_joint": "bent"}), "not a position"),
])
def test_bad_tables(fault, expected, tmp_path) -> None:
    tables = _tables()
    fault(tables)
    file = tmp_path / "tables.json"
    file.write_text(json.dumps(tables))
    with pytest.raises(ValueError, match=expected):
        make_retargeter(ik_config=file)


def test_invalid_files(tmp_path) -> None:
    (tmp_path / "broken.json").write_text("{")
    (tmp_path / "list.json").write_text("[]")
    for name in ("broken.json", "list.json"):
        with pytest.raises(ValueError, match=name):
            make_retargeter(ik_config=tmp_path / name)
    with pytest.raises(OSError):
        make_retargeter(ik_config=tmp_path / "missing.json")
    with pytest.raises(ValueError, match="there is no folder"):
        use_published_files(tmp_path / "nowhere")


def test_a_motion_may_start_elsewhere(tmp_path) -> None:
    tables = _tables() | {"robot_initial_qpos": {"left_knee_joint": 0.5,
                                                 "floating_base": [0, 0, 1, 1, 0, 0, 0]}}
    file = tmp_path / "tables.json"
    file.write_text(json.dumps(tables))
    retargeter = make_retargeter(ik_config=file)
    assert retargeter.qpos[7 + retargeter.robot_motor_names["left_knee_joint"]] == 0.5
    np.testing.assert_array_equal(retargeter.qpos[:4], [0, 0, 1, 1])


def test_bad_scales_are_errors_and_good_ones_count_again() -> None:
    frame = sample_frames("walk", 1)[0]
    retargeter = make_retargeter()
    expected = make_retargeter().retarget(frame)
    for bad in ("big", None, NAN, [1.0]):
        good = retargeter.human_scale_table["LeftHand"]
        retargeter.human_scale_table["LeftHand"] = bad
        with pytest.raises(ValueError):
            retargeter.retarget(frame)
        retargeter.human_scale_table["LeftHand"] = good
    np.testing.assert_array_equal(retargeter.retarget(frame), expected)


def _resident_kib() -> int:
    for line in pathlib.Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    pytest.skip("the system does not report resident memory")


def test_calls_do_not_make_memory_grow() -> None:
    """RETARGET_PYTHON_CALLS=100000 makes a long run."""
    if os.environ.get("LD_PRELOAD"):
        pytest.skip("a sanitizer keeps freed memory")
    calls = int(os.environ.get("RETARGET_PYTHON_CALLS", 2_000))
    frames = sample_frames("wave", 50)
    bad = frames[0] | {"Hips": ([0.0], [0.0])}
    retargeter = make_retargeter()

    def loop(count: int) -> None:
        for i in range(count):
            retargeter.retarget(frames[i % len(frames)], offset_to_ground=i % 2 == 0)
            if i % 10 == 0:
                retargeter.scaled_human_data
                retargeter.error1()
                with pytest.raises(ValueError):
                    retargeter.retarget(bad)
            if i % 500 == 0:
                GeneralMotionRetargeting("bvh", "unitree_g1", 1.75, verbose=False)

    loop(1_000)
    gc.collect()
    before = _resident_kib()
    loop(calls)
    gc.collect()
    grown = _resident_kib() - before
    assert grown < 4_096, f"{grown} KiB in {calls} calls"
    assert sys.getrefcount(frames[0]) < 5
