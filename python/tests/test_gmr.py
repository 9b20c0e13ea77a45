"""The published class: results, state, attributes, the forms of its arguments."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from gmr_support import DATA, make_retargeter, same_signs, sample_frames, tool_qpos

import retarget.gmr
from retarget.gmr import GeneralMotionRetargeting
from retarget.gmr.params import IK_CONFIG_DICT, ROBOT_XML_DICT


@pytest.mark.parametrize("name", ["walk", "get_up", "turn_in_place"])
def test_a_loop_gives_what_the_command_gives(name, tmp_path) -> None:
    expected = tool_qpos(DATA / f"{name}.bvh", tmp_path / "out.csv")
    retargeter = make_retargeter()
    found = np.array([retargeter.retarget(frame) for frame in sample_frames(name)])
    assert found.shape == expected.shape and found.dtype == np.float64
    # The loader's rounding errors accumulate over the frames.
    np.testing.assert_allclose(same_signs(found, expected), expected, rtol=0, atol=1e-9)


def test_every_robot_with_tables_of_ours_gives_what_the_command_gives(tmp_path) -> None:
    names = [name for name in IK_CONFIG_DICT["bvh_lafan1"]
             if "unverified" not in str(ROBOT_XML_DICT.get(name, "unverified"))]
    assert {"unitree_g1", "booster_t1_29dof", "fourier_n1", "stanford_toddy"} <= set(names)
    frames = sample_frames("wave", 40)
    for name in names:
        expected = tool_qpos(DATA / "wave.bvh", tmp_path / f"{name}.csv", name)[:len(frames)]
        retargeter = make_retargeter(tgt_robot=name)
        found = np.array([retargeter.retarget(frame) for frame in frames])
        # Columns are in the profile's order, configurations in the model's order.
        columns = [retargeter.robot_dof_names[joint] + 1
                   for joint in retarget.Robot(name).joint_names]
        found = found[:, [*range(7), *columns]]
        np.testing.assert_allclose(same_signs(found, expected), expected, rtol=0, atol=1e-9,
                                   err_msg=name)


def test_arguments_of_all_published_forms_give_the_same() -> None:
    frame = sample_frames("walk", 1)[0]
    expected = make_retargeter().retarget(frame)
    forms = {
        "tuples": {name: (p, q) for name, (p, q) in frame.items()},
        "lists": {name: [p.tolist(), q.tolist()] for name, (p, q) in frame.items()},
        "strided": {name: (np.repeat(p, 2)[::2], np.repeat(q, 3)[::3])
                    for name, (p, q) in frame.items()},
        "big endian": {name: (p.astype(">f8"), q.astype(">f8")) for name, (p, q) in frame.items()},
        "read-only": {name: (np.broadcast_to(p, (2, 3))[1], q) for name, (p, q) in frame.items()},
        "not of unit length": {name: (p, 2.0 * q) for name, (p, q) in frame.items()},
        "more bodies": frame | {"Tail": ("no", "pose")},
    }
    for form, given in forms.items():
        np.testing.assert_allclose(make_retargeter().retarget(given), expected, rtol=0, atol=1e-12,
                                   err_msg=form)
    single = {name: (p.astype("f4"), q.astype("f4")) for name, (p, q) in frame.items()}
    np.testing.assert_allclose(make_retargeter().retarget(single), expected, atol=1e-4)
    assert all(isinstance(pose, list) for pose in frame.values())  # the input is unchanged


def test_integers_count_as_numbers() -> None:
    frame = {name: (np.array([0, 0, 1]), [1, 0, 0, 0]) for name in sample_frames("walk", 1)[0]}
    floats = {name: ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0]) for name in frame}
    np.testing.assert_array_equal(make_retargeter().retarget(frame),
                                  make_retargeter().retarget(floats))


def test_the_state_carries_over_and_can_be_set() -> None:
    frames = sample_frames("squat", 20)
    one = make_retargeter()
    for frame in frames[:10]:
        half = one.retarget(frame)
    whole = [one.retarget(frame) for frame in frames[10:]]
    other = make_retargeter()
    other.qpos = half
    np.testing.assert_array_equal(other.qpos, half)
    np.testing.assert_array_equal([other.retarget(frame) for frame in frames[10:]], whole)
    half[:] = 0.0  # The array belongs to the caller.
    assert np.linalg.norm(other.qpos[3:7]) == pytest.approx(1.0)
    other.setup_retarget_configuration()
    np.testing.assert_array_equal(other.retarget(frames[0]), make_retargeter().retarget(frames[0]))


def test_errors_fall_as_frames_are_solved() -> None:
    retargeter = make_retargeter()
    frame = sample_frames("walk", 1)[0]
    with pytest.raises(ValueError, match="no targets yet"):
        retargeter.error1()
    retargeter.update_targets(frame)
    before = retargeter.error1(), retargeter.error2()
    retargeter.retarget(frame)
    after = retargeter.error1(), retargeter.error2()
    assert before[0] == before[1] > after[1] > 0.0
    # The error norm includes the rotations, so it is at least the norm of the position errors.
    positions, _ = retarget.Robot("unitree_g1").forward_kinematics(retargeter.qpos)
    away = [positions[retargeter.robot_body_names[body]] - retargeter.scaled_human_data[row[0]][0]
            for body, row in retargeter.ik_match_table1.items()]
    assert after[0] > 0.9 * np.linalg.norm(away)


def test_targets_are_scaled_and_offset_step_by_step() -> None:
    retargeter = make_retargeter()
    frame = sample_frames("walk", 1)[0]
    with pytest.raises(AttributeError, match="after retarget"):
        retargeter.scaled_human_data
    retargeter.update_targets(frame)
    data = retargeter.to_numpy(frame)
    data = retargeter.scale_human_data(data, retargeter.human_root_name,
                                       retargeter.human_scale_table)
    data = retargeter.offset_human_data(data, retargeter.pos_offsets1, retargeter.rot_offsets1)
    found = retargeter.scaled_human_data
    assert set(data) == set(found) == set(retargeter.human_scale_table)
    for name, (position, rotation) in found.items():
        np.testing.assert_allclose(data[name][0], position, rtol=0, atol=1e-15)
        np.testing.assert_allclose(data[name][1], rotation, rtol=0, atol=1e-15)
    # Computed by hand.
    scales, root = retargeter.human_scale_table, frame["Hips"][0]
    assert scales["LeftHand"] == 0.75 * 1.75 / 1.8
    np.testing.assert_allclose(
        found["LeftHand"][0],
        scales["Hips"] * root + scales["LeftHand"] * (frame["LeftHand"][0] - root), atol=1e-15)


def test_offsets_to_the_ground() -> None:
    frame = sample_frames("walk", 1)[0]
    retargeter = make_retargeter()
    retargeter.update_targets(frame)
    plain = retargeter.scaled_human_data
    retargeter.retarget(frame, offset_to_ground=True)
    found = retargeter.scaled_human_data
    assert min(found[side + "FootMod"][0][2] for side in ("Left", "Right")) == pytest.approx(0.1)
    by_steps = retargeter.offset_human_data_to_ground(plain)
    for name, (position, _) in found.items():
        np.testing.assert_array_equal(by_steps[name][0], position)
    retargeter.set_ground_offset(0.25)
    retargeter.update_targets(frame)
    lowered = retargeter.apply_ground_offset(plain)
    for name, (position, _) in retargeter.scaled_human_data.items():
        np.testing.assert_array_equal(lowered[name][0], position)


def test_changed_attributes_count_from_the_next_frame() -> None:
    frames = sample_frames("walk", 3)
    retargeter = make_retargeter()
    before = retargeter.retarget(frames[0])
    for name in retargeter.human_scale_table:
        retargeter.human_scale_table[name] *= 1.1
    moved = retargeter.retarget(frames[0])
    assert abs(moved[2] - before[2]) > 0.05
    taller = make_retargeter(actual_human_height=1.1 * 1.75)
    taller.qpos = before
    np.testing.assert_allclose(moved, taller.retarget(frames[0]), atol=1e-9)

    damped = make_retargeter()
    damped.damping = 1e6
    start = damped.qpos
    assert np.abs(damped.retarget(frames[0]) - start).max() < 0.1 * np.abs(before - start).max()
    assert damped.damping == 1e6 and damped.error1() > retargeter.error1()
    short = make_retargeter()
    short.max_iter = 0
    short.retarget(frames[0])
    whole = make_retargeter()
    whole.retarget(frames[0])
    assert short.max_iter == 0 and short.error2() > whole.error2()
    with pytest.raises(ValueError):
        short.max_iter = 31
    with pytest.raises(ValueError):
        short.damping = -1.0
    assert (short.max_iter, short.damping) == (0, 0.5)


def test_attributes_that_callers_read() -> None:
    retargeter = GeneralMotionRetargeting("bvh_lafan1", "unitree_g1", 1.75, "proxqp", 0.5, False,
                                          True)
    assert retargeter.xml_file == str(ROBOT_XML_DICT["unitree_g1"])
    assert (retargeter.human_root_name, retargeter.robot_root_name) == ("Hips", "pelvis")
    assert (retargeter.solver, retargeter.max_iter, retargeter.damping) == ("proxqp", 10, 0.5)
    assert len(retargeter.robot_motor_names) == 29
    assert retargeter.robot_motor_names["left_hip_pitch_joint"] == 0
    assert retargeter.robot_dof_names["left_hip_pitch_joint"] == 6
    assert list(retargeter.robot_body_names)[:2] == ["world", "pelvis"]
    np.testing.assert_array_equal(retargeter.ground, np.zeros(3))
    assert retargeter.ik_match_table1["pelvis"][0] == "Hips"
    assert make_retargeter(actual_human_height=None).human_scale_table["Hips"] == 0.9


def test_unsupported_attributes_raise_clear_errors() -> None:
    retargeter = make_retargeter()
    for name, instead in (("configuration", "qpos"), ("tasks1", "error1"), ("ik_limits", "ranges")):
        with pytest.raises(AttributeError, match=instead):
            getattr(retargeter, name)
    with pytest.raises(AttributeError, match="no attribute 'colour'"):
        retargeter.colour
    with pytest.raises(NotImplementedError, match="retarget view"):
        retarget.gmr.RobotMotionViewer(robot_type="unitree_g1", motion_fps=30)


def test_model_needs_mujoco(monkeypatch) -> None:
    try:
        import mujoco
    except ImportError:
        with pytest.raises(AttributeError, match="pip install mujoco"):
            make_retargeter().model
    else:
        assert isinstance(make_retargeter().model, mujoco.MjModel)


def test_files_that_are_used_are_printed(capsys) -> None:
    make_retargeter(verbose=True)
    assert "model.xml" in capsys.readouterr().out
    make_retargeter()
    assert capsys.readouterr().out == ""


def test_threads_with_a_retargeter_each_give_the_same() -> None:
    frames = sample_frames("walk", 60)
    expected = make_retargeter()
    rows = [expected.retarget(frame) for frame in frames]
    results: dict[int, list] = {}

    def work(thread: int) -> None:
        retargeter = make_retargeter()
        results[thread] = [retargeter.retarget(frame) for frame in frames]

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for found in results.values():
        np.testing.assert_array_equal(found, rows)


def test_threads_may_share_one() -> None:
    frames = sample_frames("walk", 30)
    retargeter = make_retargeter()

    faults: list[BaseException] = []

    def work() -> None:
        try:
            for frame in frames:
                assert np.isfinite(retargeter.retarget(frame)).all()
                retargeter.error1()
                assert len(retargeter.scaled_human_data) == 14
        except BaseException as fault:
            faults.append(fault)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not faults
    assert np.linalg.norm(retargeter.qpos[3:7]) == pytest.approx(1.0)
