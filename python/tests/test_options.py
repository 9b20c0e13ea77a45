"""Keywords are the command's options: their names, kinds and ranges."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import retarget
from retarget import _retarget

SOURCE = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(("options", "text"), [
    ({"metod": "gmr"}, 'unknown option "metod" (did you mean "method"?)'),
    ({"lead-in": "keep"}, 'unknown option "lead-in" (did you mean "lead_in"?)'),
    ({"method": "gmt"}, 'method: expected one of fit, gmr, found "gmt" (did you mean "gmr"?)'),
    ({"method": 3}, "method: expected one of fit, gmr, found"),
    ({"fps": -1}, "fps: expected a number from 0.001 to 1000000 or `source`"),
    ({"fps": float("nan")}, "fps: expected a number"),
    ({"fps": True}, "fps: expected a number or a string, found True"),
    ({"start": "soon"}, "start: expected a number from 0 to 1000000000, found 'soon'"),
    ({"start": np.zeros(2)}, "expected a number from 0 to 1000000000, found a value of type"),
    ({"precision": 2.5}, "precision: expected a whole number from 0 to 17, found 2.5"),
    ({"precision": 18}, 'precision: expected a whole number from 0 to 17, found "18"'),
    ({"precision": 10**30}, "precision: expected a whole number from 0 to 17, found 1000"),
    ({"csv_header": "yes"}, "csv_header: expected true or false, found 'yes'"),
    ({"csv_header": 1}, "csv_header: expected true or false, found 1"),
    ({"format": ["csv", "xls"]}, "format: expected some of"),
    ({"format": {"csv": 1}}, "format: expected some of"),
    ({"without": "flor"}, "flor"),
    ({"with_": "dynamic"}, 'did you mean "dynamics"'),
    ({"for_": "trackin"}, 'did you mean "tracking"'),
    ({"for_": "tracking", "method": "gmr"}, "for and travel require method fit"),
    ({"travel": "fast"}, "travel: expected a number from 0.5 to 1.2 or `auto`"),
    ({"travel": 3}, "travel: expected a number from 0.5 to 1.2 or `auto`"),
    ({"up": "w"}, "up: expected x, y, z"),
    ({"format": "npz-mjlab", "fps": 60}, "fps has no effect on npz-mjlab"),
    ({"format": ["npz-mjlab", "csv-sonic"], "fps": 60}, "npz_fps N sets the rate of this format"),
    ({"map": "a\0b"}, "a path with a null byte"),
    ({"fit": {"contact_wight": 3.0}}, 'did you mean "contact_weight"?'),
    ({"fit": {"contact_weight": "much"}}, "contact_weight: expected a number"),
])
def test_wrong_options(options: dict[str, Any], text: str, walk, g1) -> None:
    with pytest.raises(retarget.UsageError) as raised:
        retarget.to_robot(walk, g1, **options)
    assert text in str(raised.value)


def test_a_rate_that_some_file_has(walk: retarget.Clip, g1: retarget.Robot) -> None:
    for options in ({"format": "npz-mjlab", "fps": 60, "npz_fps": 60},
                    {"format": ["npz-mjlab", "csv"], "fps": 60}, {"fps": 60}):
        assert retarget.make_plan(walk, g1, **options).options["fps"] == "60"


def test_none_and_number_types(walk: retarget.Clip, g1: retarget.Robot) -> None:
    expected = retarget.to_robot(walk, g1, fps=50, start=1, method="gmr", csv_header=True)
    same = retarget.to_robot(walk, g1, fps=np.float32(50), start=np.int64(1), method="gmr",
                             csv_header=np.bool_(True), limits=None, map=None)
    text = retarget.to_robot(walk, g1, fps="50", start=np.array(1.0), method="gmr")
    assert expected.qpos.tobytes() == same.qpos.tobytes() == text.qpos.tobytes()
    assert retarget.to_robot(walk, g1, fps="source", method="gmr").fps == walk.fps


def test_the_fit_s_own_options(walk: retarget.Clip, g1: retarget.Robot, tmp_path: Path) -> None:
    (tmp_path / "fit.json").write_text('{"contact_weight": 100.0, "floor": false}')
    by_file = retarget.to_robot(walk, g1, fit_config=tmp_path / "fit.json")
    by_name = retarget.to_robot(walk, g1, fit={"contact_weight": 100, "floor": False})
    assert by_file.qpos.tobytes() == by_name.qpos.tobytes()
    assert by_file.qpos.tobytes() != retarget.to_robot(walk, g1).qpos.tobytes()


def test_travel(walk: retarget.Clip, g1: retarget.Robot, walked: retarget.Motion) -> None:
    shorter = retarget.to_robot(walk, g1, travel=0.9)
    ways = [np.linalg.norm(motion.qpos[-1, :2] - motion.qpos[0, :2])
            for motion in (walked, shorter)]
    assert ways[1] / ways[0] == pytest.approx(0.9, abs=0.005)
    assert retarget.to_robot(walk, g1, travel="0.9").qpos.tobytes() == shorter.qpos.tobytes()
    assert retarget.evaluate(shorter).passed


def test_the_preset_for_policies(walk: retarget.Clip, g1: retarget.Robot) -> None:
    preset = retarget.to_robot(walk, g1, for_="tracking", end=2)
    calm = retarget.to_robot(walk, g1, for_="tracking", end=2, without="dynamics")
    assert preset.qpos.tobytes() != calm.qpos.tobytes()
    # Given options of the fit take precedence, even with their default values.
    given = {"smoothness_leg": 1.75, "smoothness_arm": 2.15, "smoothness_wrist": 1.65,
             "smoothness_root_position": 72.0, "smoothness_root_reference": 1.0,
             "smoothness_root_rotation": 4.0, "limb_smoothing_time": 0.019}
    usual = retarget.to_robot(walk, g1, for_="tracking", travel=1, end=2, fit=given)
    assert usual.qpos.tobytes() == retarget.to_robot(walk, g1, end=2).qpos.tobytes()


def test_source_options_need_a_path(walk: retarget.Clip, g1: retarget.Robot, data: Path) -> None:
    assert retarget.to_robot(data / "walk.bvh", g1, source_fps=60, fps="source").fps == 60
    with pytest.raises(retarget.UsageError, match=r"source_fps is an option of load\(\)"):
        retarget.to_robot(walk, g1, source_fps=60)
    with pytest.raises(retarget.UsageError, match=r"dof is an option of Robot\(\)"):
        retarget.to_robot(walk, g1, dof="23")


def test_every_option_of_the_command_is_a_keyword() -> None:
    """docs/options.md lists the command's options; `elsewhere` lists the exceptions."""
    page = (SOURCE / "docs/options.md").read_text()
    section = page.split("\n## ")[1]
    names = {name.replace("-", "_") for name in re.findall(r"`--([a-z-]+)", section)}
    elsewhere = {"bvh", "smpl", "robot", "output", "quiet", "data_dir", "sidecar", "report", "html",
                 "png", "strip", "write_map", "verbose", "help", "help_all", "version",
                 "mirror",  # retarget.edit.mirror()
                 "dynamics", "gate"}  # Options of retarget.evaluate().
    # Python keywords get a trailing underscore.
    keywords = {name.rstrip("_") for name in inspect.signature(retarget.to_robot).parameters}
    assert names - keywords <= elsewhere
    assert {"method", "fps", "precision", "source_fps", "dof", "map"} <= names & keywords


def test_a_keyword_has_one_type_in_all_functions() -> None:
    types: dict[str, set[str]] = {}
    for rows in _retarget.option_tables().values():
        for row in rows:
            types.setdefault(row["name"], set()).add(row["type"])
        names = [row["name"] for row in rows]
        assert len(names) == len(set(names)), "a keyword is in a table twice"
    several = {name for name, found in types.items() if len(found) > 1}
    # This list may only shrink: the contacts of a batch are a flag because each clip has a file;
    # scale refers to a body or a path; floor and speed are terms of the fit and numbers of edits.
    assert several == {"contacts", "scale", "floor", "speed"}


def test_signatures_and_docs_show_the_options() -> None:
    parameters = inspect.signature(retarget.load).parameters
    assert list(parameters)[:2] == ["file", "skeleton_only"] and "lenient" in parameters
    assert "source_fps: Frames per second of the source" in retarget.load.__doc__
    assert "--" not in retarget.to_robot.__doc__
    assert "**options" not in str(inspect.signature(retarget.evaluate))


def test_the_stubs_have_every_option() -> None:
    folder = Path(retarget.__file__).parent
    stub = folder / "_options.pyi"
    if not stub.exists():
        # In a build tree, the package files are links into the sources.
        stub = Path(_retarget.__file__).parent / "_options.pyi"
    if not stub.exists():
        pytest.skip("a build without stubs")
    text = stub.read_text()
    compile(text, str(stub), "exec")
    for name, rows in _retarget.option_tables().items():
        part = text.split(f"class {name}(TypedDict")[1].split("\nclass ")[0]
        for row in rows:
            kind = row["type"].replace("float", "Number")
            assert f"\n    {row['name']}: {kind} | None\n" in part
    module = (stub.parent / "_retarget.pyi").read_text()
    compile(module, "_retarget.pyi", "exec")
    assert "import retarget._options" in module and "def from_arrays(names" in module
    assert (stub.parent / "py.typed").exists()


class _Unprintable(str):
    def __repr__(self) -> str:
        raise RuntimeError("no")


class _Stopped:
    def __index__(self) -> int:
        raise KeyboardInterrupt

    def __float__(self) -> float:
        raise KeyboardInterrupt


def _neither() -> object:
    class bool_:
        def __bool__(self) -> bool:
            raise RuntimeError("neither")

    return bool_()


@pytest.mark.parametrize(("options", "text"), [
    ({"without": "a\udcff"}, 'the fit has no term "a\\xff"'),
    ({"format": "csv,\udcff"}, "format: "),
    ({"map": "\ud800"}, "invalid characters in the string"),
    ({"without": "floor,\ud800"}, "invalid characters in the string"),
    ({"precision": 10**5000}, "precision: expected a whole number from 0 to 17, found"),
    ({"start": _Unprintable("x")}, "found a value of type _Unprintable"),
    ({"csv_header": _neither()}, "found a value of type bool_"),
    ({"\udcff": 1}, "unknown option"),
])
def test_invalid_texts_and_failing_objects(options: dict[str, Any], text: str, walk,
                                                   g1) -> None:
    with pytest.raises(retarget.UsageError) as raised:
        retarget.to_robot(walk, g1, **options)
    assert text in str(raised.value)


@pytest.mark.parametrize("name", ["precision", "start"])
def test_an_interrupt_is_no_wrong_option(name: str, walk, g1) -> None:
    with pytest.raises(KeyboardInterrupt):
        retarget.to_robot(walk, g1, **{name: _Stopped()})


def test_options_of_what_is_read_or_loaded_already(walk, g1, walked, tmp_path: Path) -> None:
    walked.save(tmp_path / "walk.csv")
    for call in (lambda: retarget.to_robot(walk, g1, data_dir="."),
                 lambda: retarget.to_robot(walk, g1, dof="23"),
                 lambda: retarget.load_motion(tmp_path / "walk.csv", g1, data_dir="."),
                 lambda: retarget.load_motion(tmp_path / "walk.csv", g1, robot_xml="g1.xml"),
                 lambda: retarget.inspect(walk, source_fps=30),
                 lambda: retarget.evaluate(walked, walk, source_fps=30)):
        with pytest.raises(retarget.UsageError, match="already"):
            call()
    with pytest.raises(retarget.UsageError, match="threads: expected 0 or more"):
        retarget.to_robot(walk, g1, threads=-5)


def test_options_of_what_is_read_or_loaded_here(walked, g1, data: Path, tmp_path: Path) -> None:
    walked.save(tmp_path / "walk.csv")
    motion = retarget.load_motion(tmp_path / "walk.csv", robot_xml=g1.model)
    assert motion.joint_names == walked.joint_names
    found = retarget.inspect(data / "walk.bvh", source_fps=60).data
    assert found["fps"] == 60.0
    beside = retarget.evaluate(motion, data / "walk.bvh", source_fps=60, fps=60)
    assert beside.data["fps"] == 60.0


def test_folders_as_bytes(walk: retarget.Clip, tmp_path: Path) -> None:
    folder = bytes(tmp_path) + b"/absent\xff"
    for given in (folder, folder.decode("utf-8", "surrogateescape")):
        for call in (lambda: retarget.inspect(walk, data_dir=given),
                     lambda: retarget.edit.mirror(walk, data_dir=given),
                     lambda: retarget.Robot("unitree_g1", data_dir=given),
                     lambda: retarget.batch("walk.bvh", tmp_path / "out", "unitree_g1",
                                            data_dir=given)):
            with pytest.raises(retarget.Error, match="absent"):
                call()
    with pytest.raises(retarget.UsageError, match="data_dir: expected a path, found int"):
        retarget.edit.mirror(walk, data_dir=7)
