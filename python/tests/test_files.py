"""convert, compare, robots, view and the command give what the command line gives."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import retarget


@pytest.fixture(scope="module")
def walk_npz(walked: retarget.Motion, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("motions") / "walk.npz"
    walked.save(file, format="npz-mjlab")
    return file


@pytest.mark.parametrize("way", [
    ("csv", {}, []),
    ("csv", {"fps": 30, "csv_header": True, "precision": 9},
     ["--fps", "30", "--csv-header", "--precision", "9"]),
    ("pkl", {"format": "pkl-gmr", "dof": "23"}, ["--format", "pkl-gmr", "--dof", "23"]),
    ("npz", {"format": "npz-beyondmimic"}, ["--format", "npz-beyondmimic"]),
])
@pytest.mark.filterwarnings("ignore::retarget.RetargetWarning")
def test_convert(way: tuple, walk_npz: Path, tmp_path: Path, command) -> None:
    ending, keywords, words = way
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    written = retarget.convert(walk_npz, tmp_path / f"a/walk.{ending}", "g1", **keywords)
    assert written == [tmp_path / f"a/walk.{ending}"]
    command("convert", walk_npz, tmp_path / f"b/walk.{ending}", "--robot", "g1", *words)
    assert written[0].read_bytes() == (tmp_path / f"b/walk.{ending}").read_bytes()


def test_convert_to_several_formats(walk_npz: Path, tmp_path: Path) -> None:
    written = retarget.convert(walk_npz, tmp_path / "walk", "g1", format=["csv", "pkl-gmr"])
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(p.name for p in written)
    assert len(written) == 2


def test_convert_a_human(data: Path, tmp_path: Path, command) -> None:
    retarget.convert(data / "wave.bvh", tmp_path / "wave.glb", fps=20)
    (tmp_path / "b").mkdir()
    command("convert", data / "wave.bvh", tmp_path / "b/wave.glb", "--fps", "20")
    assert (tmp_path / "wave.glb").read_bytes() == (tmp_path / "b/wave.glb").read_bytes()


def test_convert_spares_its_input(walk_npz: Path, tmp_path: Path) -> None:
    before = walk_npz.read_bytes()
    with pytest.raises(retarget.UsageError):
        retarget.convert(walk_npz, walk_npz, "g1", format="npz-mjlab")
    assert walk_npz.read_bytes() == before
    with pytest.raises(TypeError, match='unknown option "formt".*did you mean "format"'):
        retarget.convert(walk_npz, tmp_path / "x.csv", "g1", formt="csv")
    with pytest.raises(retarget.UsageError):
        retarget.convert(walk_npz, tmp_path / "x.csv")
    assert list(tmp_path.iterdir()) == []


def words(text: str) -> str:
    """Undoes the command's line breaks."""
    return " ".join(text.split())


def test_compare(walked: retarget.Motion, walk: retarget.Clip, g1: retarget.Robot,
                 tmp_path: Path, command) -> None:
    same = retarget.compare(walked, walked)
    assert same and same.agree and same.largest == 0.0 and same.columns == []
    assert same.frames == (len(walked), len(walked))
    walked.save(tmp_path / "a.csv")
    assert not retarget.compare(walked, tmp_path / "a.csv", tolerance=0)
    assert retarget.compare(walked, tmp_path / "a.csv", tolerance=1e-6)
    moved = walked.qpos.copy()
    moved[40:43, 9] += 0.25
    other = retarget.Motion.from_qpos(moved, g1, 30)
    found = retarget.compare(walked, other)
    assert not found and found.largest == pytest.approx(0.25)
    [column] = found.columns
    assert column.column == g1.joint_names[2]
    assert (column.first_frame, column.frames_beyond) == (40, 3) and 40 <= column.largest_frame < 43
    other.save(tmp_path / "b.csv")
    printed = words(command("compare", tmp_path / "a.csv", tmp_path / "b.csv", code=1).stderr)
    plain = retarget.compare(tmp_path / "a.csv", tmp_path / "b.csv")
    assert all(line in printed for line in plain.lines) and str(plain).splitlines() == plain.lines
    printed = words(command("compare", tmp_path / "a.csv", tmp_path / "b.csv", "--robot", "g1",
                            code=1).stderr)
    assert all(line in printed for line in
               retarget.compare(tmp_path / "a.csv", tmp_path / "b.csv", "g1").lines)
    # q and -q are the same rotation.
    flipped = walked.qpos.copy()
    flipped[:, 3:7] *= -1.0
    assert retarget.compare(walked, retarget.Motion.from_qpos(flipped, g1, 30))


def test_compare_different_motions(walked: retarget.Motion, tmp_path: Path) -> None:
    assert not retarget.compare(walked, walked[:-1]).agree
    assert not retarget.compare(walked, walked.resample(60)[:len(walked)], tolerance=1.0).agree
    with pytest.raises(retarget.UsageError, match="dof needs a robot"):
        retarget.compare(tmp_path / "a.csv", tmp_path / "b.csv", dof="23")
    with pytest.raises(retarget.UsageError, match="tolerance"):
        retarget.compare(walked, walked, tolerance=float("nan"))


def test_convert_takes_a_loaded_robot(walk_npz: Path, tmp_path: Path, g1: retarget.Robot) -> None:
    for name, robot in (("a.csv", g1), ("b.csv", "g1")):
        retarget.convert(walk_npz, tmp_path / name, robot)
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_robots(command, g1: retarget.Robot) -> None:
    listed = retarget.robots()
    assert [robot.name for robot in listed] == sorted(robot.name for robot in listed)
    output = json.loads(command("robots", "list", "--json").stdout)
    assert [(robot.name, robot.joints, robot.height) for robot in listed] == [
        (each["name"], each.get("joints"), each.get("height_m")) for each in output]
    [one] = [robot for robot in listed if robot.name == "unitree_g1"]
    assert one.installed and one.has_configuration and one.licence_stated
    assert one.joints == len(g1.joint_names) and 1.2 < one.height < 1.4
    facts = retarget.robot_facts("g1")
    assert facts == json.loads(command("robots", "show", "g1", "--json").stdout)
    assert [joint["name"] for joint in facts["joints"]] == g1.joint_names
    with pytest.raises(retarget.ConfigError, match="did you mean"):
        retarget.robot_facts("unitre_g1")


def test_facts_of_a_name_of_two_robots_are_a_warning(data: Path, tmp_path: Path,
                                                     monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(data.parent / "robots/unitree_h1", tmp_path / "g1")
    monkeypatch.chdir(tmp_path)
    with pytest.warns(retarget.RetargetWarning, match="not the robot unitree_g1"):
        facts = retarget.robot_facts("g1")
    assert len(facts["joints"]) == 19


def test_a_page_is_the_command_s(g1: retarget.Robot, data: Path, tmp_path: Path, command) -> None:
    # A page names its file: the output of the command, the source in Python. They are equal here.
    (tmp_path / "in").mkdir()
    source = tmp_path / "in/walk.csv"
    source.write_bytes((data / "walk.bvh").read_bytes())
    motion = retarget.to_robot(source, g1)
    page = retarget.view(motion, tmp_path / "a.html")
    command(source, "g1", "-o", tmp_path / "walk.csv", "--html", tmp_path / "b.html")
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()
    assert page.html.encode() == (tmp_path / "a.html").read_bytes()


def test_a_page_of_files(walk_npz: Path, data: Path, tmp_path: Path, command) -> None:
    retarget.view(walk_npz, tmp_path / "a.html", robot="g1", clip=data / "walk.bvh",
                  labels=walk_npz.name)
    command("view", walk_npz, "--robot", "g1", "--bvh", data / "walk.bvh", "-o",
            tmp_path / "b.html")
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()


def test_damaged_meshes_of_a_page_are_warnings(walked: retarget.Motion, tmp_path: Path) -> None:
    (tmp_path / "left_knee_link.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "right_knee_link.obj").write_text("v 0 0 0\nv 1 0 x\n")
    with pytest.warns(match=r"cannot be read: right_knee_link\.obj"):
        retarget.view(walked[:10], meshes=tmp_path)


def test_pages_side_by_side(walked: retarget.Motion, walk: retarget.Clip,
                            g1: retarget.Robot) -> None:
    other = retarget.to_robot(walk, g1, method="gmr")
    page = retarget.view([walked, other, walked[:50]], labels=["fit", "<gmr>", "part"], title="both")
    assert "both" in page.html and "<gmr>" not in page.html
    assert page._repr_html_().startswith("<iframe srcdoc=")
    with pytest.raises(retarget.UsageError, match="labels: expected 2 of them, found 1"):
        retarget.view([walked, other], labels="one")
    with pytest.raises(retarget.UsageError, match="at least one"):
        retarget.view([])
    with pytest.raises(retarget.UsageError, match="a file needs robot="):
        retarget.view("walk.csv")
    with pytest.raises(TypeError, match="motions: expected motions or paths"):
        retarget.view([3])


def test_pictures_are_the_command_s(g1: retarget.Robot, data: Path, walked: retarget.Motion,
                                    tmp_path: Path, command) -> None:
    content = retarget.picture(walked, tmp_path / "a.png", poses=4)
    command(data / "walk.bvh", "g1", "-o", tmp_path / "walk.csv", "--png", tmp_path / "b.png",
            "--strip", 4)
    assert content == (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    part = retarget.load_motion(tmp_path / "walk.csv", g1)
    retarget.picture(part, tmp_path / "a.svg", title="walk.csv, unitree_g1")
    command("view", tmp_path / "walk.csv", "--robot", "g1", "-o", tmp_path / "b.svg")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    with pytest.raises(retarget.UsageError, match="poses: expected 1 to 100, found 0"):
        retarget.picture(walked, poses=0)
    with pytest.raises(TypeError, match="motion: expected a Motion, found str"):
        retarget.picture("walk.csv")
    for poses in (2.5, True, "4"):
        with pytest.raises(retarget.UsageError, match="poses: expected a whole number"):
            retarget.picture(walked, poses=poses)
    with pytest.raises(retarget.UsageError, match="motion: expected a Motion, found NoneType"):
        retarget.evaluate(None)


def test_a_page_that_cannot_be_written_keeps_the_old_one(walked: retarget.Motion,
                                                         tmp_path: Path) -> None:
    page = retarget.view(walked, tmp_path / "a.html")
    old = (tmp_path / "a.html").read_bytes()
    # No file may grow beyond 100 kB in this process.
    program = ("import resource, signal, sys, retarget\n"
               "motion = retarget.load_motion(sys.argv[1], 'unitree_g1', fps=30)\n"
               "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
               "resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))\n"
               "try: retarget.view(motion, sys.argv[2])\n"
               "except retarget.RunError as error: print('refused', error.file)\n")
    walked.save(tmp_path / "a.csv")
    done = subprocess.run([sys.executable, "-c", program, tmp_path / "a.csv", tmp_path / "a.html"],
                          capture_output=True, text=True, check=True)
    assert done.stdout == f"refused {tmp_path / 'a.html'}\n"
    assert (tmp_path / "a.html").read_bytes() == old
    for write in (page.save, lambda file: retarget.picture(walked, file)):
        for file in (tmp_path / "none/x", tmp_path):
            with pytest.raises(retarget.Error):
                write(file)
        with pytest.raises(retarget.UsageError, match="unsupported extension"):
            write(tmp_path / "x.csv")
    assert not (tmp_path / "x.csv").exists()


def test_notebooks(walked: retarget.Motion) -> None:
    player = walked._repr_html_()
    assert player.startswith("<iframe") and player.endswith("</iframe>")
    assert 'sandbox="allow-scripts"' in player and player.count("<iframe") == 1
    # No quote of the page may end the attribute.
    assert player.count('"') == 10
    table = retarget.evaluate(walked)._repr_html_()
    assert table.count("<tr>") == 1 + len(retarget.evaluate(walked).data["gates"])
    assert "joint_offset_rad" in table and "<td>passed</td>" in table
    strict = retarget.evaluate(walked, gates={"peak_speed": 0.1})._repr_html_()
    assert "<b>missed</b>" in strict and "<td>rad/s</td><td>&le; 0.1</td>" in strict


def test_the_module_runs_the_command(tool: str) -> None:
    # Only the module needs the sanitizer library.
    environment = {k: v for k, v in os.environ.items() if k != "LD_PRELOAD"}
    package = Path(retarget.__file__).parent
    if not ((package / "bin/retarget").is_file()
            or (package.parents[1] / "tools/retarget/retarget").is_file()):
        pytest.skip("the command was not built here")
    if "LD_PRELOAD" in os.environ:
        pytest.skip("the package cannot be imported without the sanitizer library")
    done = subprocess.run([sys.executable, "-m", "retarget", "--version"], text=True,
                          capture_output=True, env=environment, timeout=100)
    printed = subprocess.run([tool, "--version"], text=True, capture_output=True, env=environment,
                             timeout=100)
    assert done.returncode == 0 and done.stdout == printed.stdout
    assert re.match(r"retarget \d", done.stdout)
    wrong = subprocess.run([sys.executable, "-m", "retarget", "robots"], text=True,
                           capture_output=True, env=environment, timeout=100)
    assert wrong.returncode == 2


def test_python_sources_use_public_headers_alone() -> None:
    folder = Path(__file__).resolve().parents[1] / "src"
    if not folder.is_dir():
        pytest.skip("there are no sources here")
    public = folder.parents[1] / "include"
    for file in [*folder.glob("*.cpp"), *folder.glob("*.h")]:
        for name in re.findall(r'#include "([^"]+)"', file.read_text()):
            assert (folder / name).is_file() or (public / name).is_file(), (file.name, name)


def test_live_follows_a_clip(walk: retarget.Clip, g1: retarget.Robot) -> None:
    source = [(walk.local_rotations_wxyz[i], walk.local_positions[i], i / 30) for i in range(90)]
    seen = []
    with retarget.live(walk, g1, source=source, callback=seen.append, fps=50) as session:
        assert session.state == "waiting" and session.due is None
        frames = list(session)
    assert [frame.index for frame in frames] == list(range(len(frames))) and len(frames) > 140
    assert [frame.index for frame in seen] == [frame.index for frame in frames]
    assert session.statistics["received"] == 90 and session.statistics["robot_frames"] >= 140
    last = frames[140]
    assert last.state == "following" and last.qpos.shape == (36,)
    # The robot walks with the human.
    assert np.ptp([frame.qpos[0:2] for frame in frames], axis=0).max() > 0.3
    motion = retarget.Motion.from_qpos([frame.qpos for frame in frames], g1, 50)
    assert retarget.evaluate(motion, gates=False).figures["peak_speed"] < 40.0


def test_live_frames_are_the_same_again(walk: retarget.Clip, g1: retarget.Robot) -> None:
    def run(mode: str) -> bytes:
        source = ((walk.local_rotations_wxyz[i], walk.local_positions[i], i / 30)
                  for i in range(45))
        with retarget.live(walk, g1, source=source, mode=mode) as session:
            return b"".join(frame.qpos.tobytes() for frame in session)

    for mode in ("frame", "lag"):
        assert run(mode) == run(mode) != b""


def test_live_by_hand(walk: retarget.Clip, g1: retarget.Robot) -> None:
    with retarget.live(walk, "unitree_g1", fps=100) as session:
        frames = []
        for i in range(10):
            frames += session.push(walk.local_rotations_wxyz[i], walk.local_positions[i], now=i / 30)
        frames += session.pull(now=0.5)
        assert len(frames) > 20
        with pytest.raises(retarget.UsageError, match="has no source"):
            list(session)
        assert session.robot.name == "unitree_g1"
    with pytest.raises(retarget.RunError, match="has ended"):
        session.push(walk.local_rotations_wxyz[0], walk.local_positions[0])
    assert session.close() == []


def test_wrong_live_frames(walk: retarget.Clip, g1: retarget.Robot) -> None:
    rotations, positions = walk.local_rotations_wxyz[0], walk.local_positions[0]
    with retarget.live(walk, g1) as session:
        for wrong, text in (((rotations[1:], positions), r"rotations_wxyz: expected shape \(22, 4\)"),
                            ((rotations, positions[:, :2]), r"positions: expected shape \(22, 3\)"),
                            ((2 * rotations, positions), r"rotations_wxyz\[0\]: expected a unit"),
                            ((rotations, positions * np.nan), "expected a finite number")):
            with pytest.raises(retarget.UsageError, match=text):
                session.push(*wrong)
    with pytest.raises(TypeError, match='unknown option "metod".*did you mean "method"'):
        retarget.live(walk, g1, metod="gmr")
    with pytest.raises(retarget.UsageError, match="fps: expected a number from 1 to 1000"):
        retarget.live(walk, g1, fps=0)
    with pytest.raises(TypeError, match="callback: expected a function"):
        retarget.live(walk, g1, callback=3)
    with pytest.raises(retarget.UsageError, match="source: expected"):
        with retarget.live(walk, g1, source=[rotations]) as session:
            list(session)
