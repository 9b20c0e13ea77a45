"""Errors are exceptions with the command's text, place and hint; options are keywords."""

from __future__ import annotations

import errno
import pickle
import re
import warnings
from pathlib import Path

import numpy as np
import pytest

import retarget


def spelled(text: str) -> str:
    """Spells the options in a message of the command as keywords."""
    words = []
    for word in text.split(" "):
        words.append(word[2:].replace("-", "_") if word.startswith("--") else word)
    return " ".join(words)


def test_the_text_is_the_command_s(data: Path, tmp_path: Path, command) -> None:
    broken = tmp_path / "broken.bvh"
    lines = (data / "walk.bvh").read_text().splitlines(keepends=True)
    lines[-1] = "1.0 2.0 oops\n"
    broken.write_text("".join(lines))
    printed = command(broken, "g1", "-o", tmp_path / "out.csv", code=3).stderr
    with pytest.raises(retarget.InputError) as raised:
        retarget.to_robot(broken, "g1")
    error = raised.value
    assert spelled(printed.strip()).endswith(str(error))
    assert error.kind == "input" and error.file == str(broken) and error.line == len(lines)
    assert error.column > 0 and error.message in str(error) and error.hint in str(error)
    assert not (tmp_path / "out.csv").exists()


def test_hints_are_no_broken_commands(data: Path, tmp_path: Path) -> None:
    for call in (lambda: retarget.batch([], tmp_path / "o", "unitree_g1"),
                 lambda: retarget.load_motion(data / "walk.bvh", "g1"),
                 lambda: retarget.load(tmp_path)):
        with pytest.raises(retarget.Error) as raised:
            call()
        hint = raised.value.hint
        assert hint and not re.search(r"\b(robot|bvh|help)\b (NAME|unitree|converts|shows)", hint)


NOT_GIVEN = (0, 0.0, "", b"", [], (), False)


def test_arguments_of_a_wrong_type_raise_type_errors(
        data: Path, walk: retarget.Clip, g1: retarget.Robot, walked: retarget.Motion) -> None:
    calls = {
        "clip: expected a Clip or a path, found NoneType": [
            lambda: retarget.inspect(None), lambda: retarget.to_robot(None, g1),
            lambda: retarget.to_robot(None, g1, source_fps=30)],
        "file: expected a path, found": [
            lambda: retarget.load(None), lambda: retarget.load(7), lambda: retarget.inspect([]),
            lambda: retarget.to_robot(0, g1), lambda: retarget.load_motion(None, g1)],
        "robot: expected a path, found": [lambda: retarget.Robot(0),
                                          lambda: retarget.to_robot(walk, [])],
        "fps: expected a number or a string, found": [lambda: retarget.to_robot(walk, g1, fps=[])],
        "antialias: expected True or False, found 0": [
            lambda: retarget.edit.resample(walk, 30, antialias=0)],
    }
    for text, wrong in calls.items():
        for call in wrong:
            with pytest.raises(TypeError, match=text) as raised:
                call()
            # Callers that catch the package's errors catch it as well.
            assert isinstance(raised.value, retarget.UsageError)
            assert raised.value.kind == "usage"


@pytest.mark.parametrize("given", NOT_GIVEN)
def test_the_fit_s_options_are_a_mapping(given: object, walk, g1) -> None:
    with pytest.raises(TypeError, match="fit: expected a mapping of options, found "):
        retarget.to_robot(walk, g1, fit=given)


def test_a_mapping_of_no_options_is_the_default_fit(walk, g1) -> None:
    plain = retarget.to_robot(walk, g1, end=0.1).qpos.tobytes()
    assert retarget.to_robot(walk, g1, end=0.1, fit={}).qpos.tobytes() == plain


def test_an_empty_text_is_no_option_left_out(data: Path, walk, g1, tmp_path: Path) -> None:
    """As on the command line, an unset environment variable must not select the default."""
    for name in ("limits", "ik_config", "fit_config", "map", "unit", "frames", "tpose_file"):
        for empty in ("", b""):
            with pytest.raises(retarget.UsageError, match=f"{name}: .* found an empty string"):
                retarget.to_robot(walk, g1, **{name: empty})
    for name in ("split", "clips", "shard", "relative_to", "base", "exclude", "list", "gate"):
        with pytest.raises(retarget.UsageError, match=f"{name}: .* found an empty string"):
            retarget.batch(data / "walk.bvh", tmp_path / "out", g1.name, **{name: ""})
    for call in (lambda: retarget.Robot("g1", data_dir=""),
                 lambda: retarget.inspect(walk, data_dir=b"")):
        with pytest.raises(retarget.UsageError, match="found an empty string"):
            call()
    assert list(tmp_path.iterdir()) == []


def test_kinds_and_bases(data: Path, walk: retarget.Clip, g1: retarget.Robot,
                         walked: retarget.Motion, tmp_path: Path) -> None:
    wrong = [
        (retarget.InputError, ValueError, lambda: retarget.load("nowhere.bvh")),
        (retarget.InputError, ValueError, lambda: retarget.load(data)),
        (retarget.ConfigError, ValueError, lambda: retarget.Robot("g2")),
        (retarget.ConfigError, ValueError, lambda: retarget.Robot("g1", data_dir=tmp_path)),
        (retarget.ConfigError, ValueError, lambda: retarget.to_robot(walk, g1, map="none.json")),
        (retarget.UsageError, ValueError, lambda: retarget.Robot()),
        (retarget.UsageError, ValueError, lambda: retarget.to_robot(walk, g1, start=9, end=1)),
        (retarget.UsageError, ValueError, lambda: retarget.load(7)),
        (retarget.UsageError, ValueError, lambda: retarget.load("a\0b")),
        (retarget.UsageError, ValueError, lambda: walked.save(tmp_path / "walk.npz")),
        (retarget.RunError, RuntimeError, lambda: retarget.edit.loop(walk, threshold=1e-7)),
    ]
    for kind, base, call in wrong:
        with pytest.raises(kind) as raised:
            call()
        assert isinstance(raised.value, (base, retarget.Error))
        assert isinstance(raised.value, retarget.Error) and str(raised.value)
        assert "--" not in str(raised.value), raised.value
    assert list(tmp_path.iterdir()) == []


def test_unknown_robot_suggests_the_nearest() -> None:
    with pytest.raises(retarget.ConfigError, match='did you mean "unitree_g1"'):
        retarget.Robot("unitre_g1")


def test_errors_travel_between_processes() -> None:
    with pytest.raises(retarget.InputError) as raised:
        retarget.load("nowhere.bvh")
    again = pickle.loads(pickle.dumps(raised.value))
    assert type(again) is type(raised.value) and isinstance(again, retarget.InputError)
    assert str(again) == str(raised.value) and again.file == "nowhere.bvh"


def test_names_that_are_not_utf8(walk: retarget.Clip, tmp_path: Path) -> None:
    name = b"wa\xfflk.bvh"
    walk.save(bytes(tmp_path) + b"/" + name)
    clip = retarget.load(bytes(tmp_path) + b"/" + name)
    assert clip.name.endswith("wa\\xfflk.bvh") and "wa" in repr(clip)
    with pytest.raises(retarget.InputError, match="absent"):
        retarget.load(bytes(tmp_path) + b"/absent\xff.bvh")


def test_warnings_are_python_s(data: Path, tmp_path: Path) -> None:
    lines = (data / "walk.bvh").read_text().splitlines(keepends=True)
    (tmp_path / "cut.bvh").write_text("".join(lines[:-1]) + lines[-1][:20])
    with pytest.raises(retarget.InputError):
        retarget.load(tmp_path / "cut.bvh")
    with pytest.warns(retarget.RetargetWarning, match="cut.bvh"):
        clip = retarget.load(tmp_path / "cut.bvh", lenient=True)
    assert clip.warnings
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        retarget.load(data / "walk.bvh")
        with pytest.raises(retarget.RetargetWarning):
            retarget.load(tmp_path / "cut.bvh", lenient=True)


def test_hostile_arguments(walk: retarget.Clip, g1: retarget.Robot,
                           walked: retarget.Motion) -> None:
    for call in (lambda: g1.forward_kinematics(np.zeros(36)),
                 lambda: g1.forward_kinematics(np.zeros(35)),
                 lambda: g1.forward_kinematics(None),
                 lambda: g1.forward_kinematics([float("nan")] * 36),
                 lambda: walked.tracking(format="csv"),
                 lambda: g1.joint_limits("nothing")):
        with pytest.raises(retarget.Error):
            call()
    for call in (lambda: retarget.to_robot(walk, g1, threads="many"),
                 lambda: retarget.evaluate(walk),
                 lambda: retarget.edit.mirror(walked),
                 lambda: retarget.Clip(),
                 lambda: retarget.Motion()):
        with pytest.raises(TypeError):
            call()


def test_edits_of_other_things_than_clips(walk: retarget.Clip) -> None:
    edit = retarget.edit
    for call in (edit.mirror, edit.loop, edit.trim, edit.ground, edit.lafan1, edit.follow_path,
                 lambda clip: edit.resample(clip, 60), lambda clip: edit.turn(clip, 90),
                 lambda clip: edit.move(clip, 1, 0), lambda clip: edit.rest(clip, walk),
                 lambda clip: edit.transfer(clip, walk)):
        with pytest.raises(retarget.UsageError, match="clip: expected a Clip, found str"):
            call("walk.bvh")
    with pytest.raises(retarget.UsageError, match="like: expected a Clip, found str"):
        edit.transfer(walk, "walk.bvh")
    with pytest.raises(retarget.UsageError, match="expected a list of Clips, found Clip"):
        edit.concatenate(walk)
    for clips in (["walk.bvh", walk], "walk.bvh"):
        with pytest.raises(retarget.UsageError, match=r"clips\[0\]: expected a Clip, found str"):
            edit.concatenate(clips)
    with pytest.raises(retarget.UsageError, match="degrees: expected a number, found 'left'"):
        edit.turn(walk, "left")
    with pytest.raises(retarget.UsageError, match="y: expected a number, found None"):
        edit.move(walk, 1, None)


def test_an_empty_clip_has_no_frames(walk: retarget.Clip) -> None:
    empty = retarget.Clip.from_arrays(
        names=walk.joint_names, parents=walk.parents, positions=walk.positions[:0],
        rotations_wxyz=walk.rotations_wxyz[:0], fps=30, space="world")
    for edit in (retarget.edit.mirror, retarget.edit.ground, retarget.edit.loop):
        with pytest.raises(retarget.InputError, match="the clip has no frames"):
            edit(empty)


def test_rates_may_be_numbers_or_texts(walk: retarget.Clip, g1: retarget.Robot) -> None:
    with pytest.raises(TypeError, match="fps: expected a number or a string, found True"):
        retarget.to_robot(walk, g1, fps=True)


def test_hostile_edits(walk: retarget.Clip) -> None:
    edit = retarget.edit
    nan = float("nan")
    for call in (lambda: edit.turn(walk, nan), lambda: edit.move(walk, nan, 0),
                 lambda: edit.move(walk, 0, float("inf")), lambda: edit.ground(walk, nan),
                 lambda: edit.loop(walk, shortest=nan), lambda: edit.loop(walk, times=0),
                 lambda: edit.loop(walk, times=10**9), lambda: edit.resample(walk),
                 lambda: edit.resample(walk, speed=0), lambda: edit.resample(walk, 1e7),
                 lambda: edit.concatenate([walk]),
                 lambda: edit.concatenate([walk, walk], window=99),
                 lambda: edit.concatenate([walk, walk], blend="mixed"),
                 lambda: edit.follow_path(walk, "circle", radius=0),
                 lambda: edit.follow_path(walk, scale=nan),
                 lambda: edit.follow_path(walk, "no.json"),
                 lambda: edit.follow_path(walk, keep="pace"), lambda: edit.trim(walk, frames="x"),
                 lambda: edit.trim(walk, frames=slice(0, 9, 2)), lambda: edit.trim(walk, start=99),
                 lambda: edit.mirror(walk, map="no.json"), lambda: edit.mirror(walk, height=-1)):
        with pytest.raises(retarget.Error) as raised:
            call()
        assert "--" not in str(raised.value)


def test_a_warning_names_the_caller_s_line(data: Path, tmp_path: Path) -> None:
    lines = (data / "walk.bvh").read_text().splitlines(keepends=True)
    (tmp_path / "cut.bvh").write_text("".join(lines[:-1]) + lines[-1][:20])
    calls = [lambda: retarget.load(tmp_path / "cut.bvh", lenient=True),
             lambda: retarget.inspect(tmp_path / "cut.bvh", lenient=True),
             lambda: retarget.to_robot(tmp_path / "cut.bvh", "g1", lenient=True, method="gmr",
                                       end=0.2)]
    for call in calls:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            call()
        places = {(each.filename, each.lineno) for each in caught}
        assert len(places) == 1
        [(file, line)] = places
        first = call.__code__.co_firstlineno
        assert file == __file__ and first <= line <= first + 1


def test_standard_output_is_not_a_file(walked: retarget.Motion) -> None:
    with pytest.raises(retarget.UsageError, match="path: expected a file"):
        walked.save("-", format="csv")


def test_a_missing_file_is_python_s_error_too(walk: retarget.Clip, g1: retarget.Robot,
                                              tmp_path: Path) -> None:
    missing = str(tmp_path / "nowhere.bvh")
    calls = [
        (retarget.InputError, lambda: retarget.load(missing)),
        (retarget.InputError, lambda: retarget.to_robot(missing, g1)),
        (retarget.InputError, lambda: retarget.load_motion(missing, g1)),
        (retarget.InputError, lambda: retarget.convert(missing, tmp_path / "x.csv", "g1")),
        (retarget.ConfigError, lambda: retarget.to_robot(walk, g1, map=missing)),
        (retarget.ConfigError, lambda: retarget.to_robot(walk, g1, fit_config=missing)),
        (retarget.ConfigError, lambda: retarget.Robot(robot_xml=missing)),
    ]
    for kind, call in calls:
        with pytest.raises(FileNotFoundError) as raised:
            call()
        error = raised.value
        assert isinstance(error, kind) and isinstance(error, ValueError)
        assert error.filename == error.file == missing and error.errno == errno.ENOENT
        # The text is that of the command, and not that of an OSError.
        assert str(error).startswith(missing) and error.message in str(error)
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error) and str(again) == str(error)
        assert again.filename == missing and again.hint == error.hint
    # A folder, and a name that is not a file, are different errors.
    for call in (lambda: retarget.load(tmp_path), lambda: retarget.Robot("g2"),
                 lambda: retarget.Clip.from_positions(np.zeros((2, 3, 3)), fps=30, name="gone")):
        with pytest.raises(retarget.Error) as raised_other:
            call()
        assert not isinstance(raised_other.value, OSError)


def test_an_unknown_keyword_is_a_type_error(data: Path, walk: retarget.Clip, g1: retarget.Robot,
                                            walked: retarget.Motion, tmp_path: Path) -> None:
    calls = {
        "method": lambda: retarget.to_robot(walk, g1, metod="gmr"),
        "precision": lambda: walked.save(tmp_path / "x.csv", precison=3),
        "format": lambda: walked.tracking(fromat="npz-mjlab"),
        "robot_xml": lambda: retarget.Robot(robot_xlm="x.xml"),
        "lenient": lambda: retarget.load(data / "walk.bvh", leniant=True),
        "dynamics": lambda: retarget.evaluate(walked, dynamcs=True),
        "resume": lambda: retarget.batch(data, tmp_path / "out", "g1", resumee=True),
        "contact_weight": lambda: retarget.to_robot(walk, g1, fit={"contact_wieght": 1.0}),
        "no_antialias": lambda: retarget.edit.resample(walk, 10, no_antialia=True),
        "mode": lambda: retarget.live(walk, g1, moode="lag"),
    }
    for meant, call in calls.items():
        with pytest.raises(TypeError, match=f'did you mean "\\w*{meant}"') as raised:
            call()
        assert isinstance(raised.value, retarget.UsageError)
    assert list(tmp_path.iterdir()) == []


def test_one_word_for_the_frame_rate(data: Path, walk: retarget.Clip, g1: retarget.Robot,
                                     walked: retarget.Motion, tmp_path: Path) -> None:
    assert retarget.load(data / "walk.bvh", fps=60).fps == 60
    assert retarget.load(data / "walk.bvh", source_fps=60).fps == 60
    walked.save(tmp_path / "walk.csv")
    assert retarget.load_motion(tmp_path / "walk.csv", g1, fps=50).fps == 50
    assert retarget.load_motion(tmp_path / "walk.csv", g1, source_fps=50).fps == 50
    for call in (lambda: retarget.load(data / "walk.bvh", fps=60, source_fps=60),
                 lambda: retarget.load_motion(tmp_path / "walk.csv", g1, fps=1, source_fps=1)):
        with pytest.raises(retarget.UsageError, match="fps and source_fps are the same option"):
            call()
    for call in (lambda: retarget.load(data / "walk.bvh", fps="fast"),
                 lambda: retarget.load(data / "walk.bvh", fps=-1)):
        with pytest.raises(retarget.UsageError, match="fps: expected"):
            call()
