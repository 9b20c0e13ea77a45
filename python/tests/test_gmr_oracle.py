"""The published class against independent results: shared files, and the reference itself."""

from __future__ import annotations

import importlib.util
import json
import types

import numpy as np
import pytest
from gmr_support import (ROOT, from_xyzw, make_retargeter, same_signs, sample_frames,
                         shared_folder)

from retarget.gmr import GeneralMotionRetargeting, params
from retarget.gmr.utils.lafan1 import load_bvh_file

TOLERANCE = 1e-6  # rad and m


def oracle() -> types.ModuleType:
    """The Python reference; skips the test where its packages are not installed."""
    pytest.importorskip("mink", reason="mink, MuJoCo and DAQP are not installed beside")
    file = shared_folder() / "oracle" / "retarget_oracle.py"
    spec = importlib.util.spec_from_file_location("retarget_oracle", file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_committed_frames_of_the_reference() -> None:
    if not (ROOT / "tests/golden/oracle").is_dir():
        pytest.skip("an installed package is tested, without the tree's tests/golden")
    for name in ("walk", "turn_in_place", "squat", "wave", "get_up"):
        file = ROOT / "tests/golden/oracle" / f"{name}.csv"
        expected = from_xyzw(np.loadtxt(file, delimiter=","))
        retargeter = make_retargeter()
        found = np.array([retargeter.retarget(frame) for frame in sample_frames(name)])
        np.testing.assert_allclose(same_signs(found, expected), expected, rtol=0, atol=TOLERANCE,
                                   err_msg=name)


def test_files_of_the_reference() -> None:
    reference = shared_folder() / "reference" / "gmr_output"
    compared = 0
    for robot in params.IK_CONFIG_DICT["bvh_lafan1"]:
        for file in sorted((reference / robot).glob("*.csv")):
            expected = from_xyzw(np.loadtxt(file, delimiter=","))
            [bvh] = (shared_folder() / "data").glob(f"lafan1*/{file.stem}.bvh")
            frames, height = load_bvh_file(bvh)
            retargeter = make_retargeter(tgt_robot=robot, actual_human_height=height)
            found = np.array([retargeter.retarget(frame) for frame in frames[:len(expected)]])
            np.testing.assert_allclose(same_signs(found, expected), expected, rtol=0,
                                       atol=TOLERANCE, err_msg=f"{robot}, {file.stem}")
            compared += 1
    assert compared >= 18


# SMPL-X names for LAFAN1's bodies; both implementations only have to get the same frames.
SMPLX = {"pelvis": "Hips", "left_hip": "LeftUpLeg", "left_knee": "LeftLeg",
         "left_ankle": "LeftFoot", "left_foot": "LeftToe", "right_hip": "RightUpLeg",
         "right_knee": "RightLeg", "right_ankle": "RightFoot", "right_foot": "RightToe",
         "spine3": "Spine2", "head": "Head", "neck": "Neck", "left_shoulder": "LeftArm",
         "left_elbow": "LeftForeArm", "left_wrist": "LeftHand", "right_shoulder": "RightArm",
         "right_elbow": "RightForeArm", "right_wrist": "RightHand"}


def smplx_frames(count: int) -> list[dict]:
    return [{name: tuple(frame[bone]) for name, bone in SMPLX.items()}
            for frame in sample_frames("walk", count)]


def golden_frames() -> list[dict]:
    """Returns the frames of tests/golden/smplx."""
    return [{name: tuple(frame[bone]) for name, bone in SMPLX.items()}
            for frame in sample_frames("walk")[::20]]


def test_committed_frames_of_the_reference_in_the_form_of_smplx() -> None:
    """Compares qpos and the error of table 2 with the reference, using this project's tables."""
    folder = ROOT / "tests/golden/smplx"
    if not folder.is_dir():
        pytest.skip("an installed package is tested, without the tree's tests/golden")
    expected = np.loadtxt(folder / "expected.csv", delimiter=",")
    retargeter = GeneralMotionRetargeting("smplx", "unitree_g1", 1.7, verbose=False,
                                          ik_config=folder / "tables.json")
    frames = golden_frames()
    assert len(frames) == len(expected) > 10
    for frame, row in zip(frames, expected):
        np.testing.assert_allclose(retargeter.retarget(frame), row[:-1], rtol=0, atol=TOLERANCE)
        assert retargeter.error2() == pytest.approx(row[-1], abs=TOLERANCE)


TABLES = [*(f"smplx_to_{name}" for name in ("g1", "n1", "pm01", "t1", "toddy", "hi", "kuavo")),
          "fbx_to_g1"]
ROBOTS = {short: name for name, (short, *_) in params._ROBOTS.items()
          if not name.endswith("with_hands")}


@pytest.mark.parametrize("tables", TABLES)
@pytest.mark.parametrize("to_ground", [False, True])
def test_the_reference_on_published_tables_and_models(tables, to_ground, monkeypatch) -> None:
    module = oracle()
    import mujoco
    reference = shared_folder() / "reference"
    robot = ROBOTS[tables.split("_to_")[1]]
    models = [reference / "robots" / model for model in params._ROBOTS[robot][1]
              if (reference / "robots" / model).is_file()]
    config_file = reference / "ik_configs" / f"{tables}.json"
    config = json.loads(config_file.read_text())
    if tables.startswith("fbx"):
        frames = [{**frame, "LeftToeBase": frame["LeftToe"], "RightToeBase": frame["RightToe"]}
                  for frame in sample_frames("walk", 30)]
    else:
        frames = smplx_frames(30)

    model = mujoco.MjModel.from_xml_string(module.kinematic_mjcf(str(models[0])))
    stacked = {name: (np.array([frame[name][0] for frame in frames]),
                      np.array([frame[name][1] for frame in frames])) for name in frames[0]}
    targets = module.make_targets(stacked, config, 1.7)
    if to_ground and tables == "fbx_to_g1":
        pytest.skip("no body of these tables has foot in its name")
    if to_ground:
        lowest = np.min([position[:, 2] for name, (position, _) in targets.items()
                         if "foot" in name.lower()], axis=0)
        targets = {name: (position - lowest[:, None] * [0, 0, 1] + [0, 0, 0.1], rotation)
                   for name, (position, rotation) in targets.items()}
    expected, errors = module.retarget(model, config, targets, len(frames))

    # The published model, and retarget's own.
    for xml in {models[0], params.ROBOT_XML_DICT.get(robot, models[0])}:
        monkeypatch.setitem(params.ROBOT_XML_DICT, robot, xml)
        retargeter = GeneralMotionRetargeting("smplx", robot, 1.7, verbose=False,
                                              ik_config=config_file)
        for frame, qpos, norms in zip(frames, expected[:, 1], errors[:, 1]):
            found = retargeter.retarget(frame, offset_to_ground=to_ground)
            np.testing.assert_allclose(found, qpos, rtol=0, atol=TOLERANCE, err_msg=str(xml))
            last = norms[~np.isnan(norms)][-1]
            assert retargeter.error2() == pytest.approx(last, abs=TOLERANCE)


def test_no_foot_to_bring_to_the_ground() -> None:
    config = shared_folder() / "reference" / "ik_configs" / "fbx_to_g1.json"
    retargeter = make_retargeter(src_human="fbx", ik_config=config)
    frame = sample_frames("walk", 1)[0]
    frame |= {"LeftToeBase": frame["LeftToe"], "RightToeBase": frame["RightToe"]}
    with pytest.raises(ValueError, match="no body of the tables has"):
        retargeter.retarget(frame, offset_to_ground=True)


def test_a_robot_on_wheels_is_refused(monkeypatch) -> None:
    reference = shared_folder() / "reference"
    monkeypatch.setitem(params.ROBOT_XML_DICT, "galaxea_r1pro",
                        reference / "robots" / "galaxea_r1pro" / "r1_pro.xml")
    with pytest.raises(ValueError, match="no free joint"):
        make_retargeter(tgt_robot="galaxea_r1pro",
                        ik_config=reference / "ik_configs" / "smplx_to_r1pro.json")
