"""While it runs: progress, Ctrl-C, other threads; batches; memory."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import pytest

import retarget


@pytest.fixture(scope="module")
def long_walk(walk: retarget.Clip) -> retarget.Clip:
    """A clip that takes seconds."""
    return retarget.edit.resample(walk, speed=0.02)


def test_progress(long_walk: retarget.Clip, g1: retarget.Robot) -> None:
    reports: list[tuple[str, int, int]] = []
    thread: set[int] = set()

    def progress(stage: str, done: int, total: int) -> None:
        reports.append((stage, done, total))
        thread.add(threading.get_ident())

    short = retarget.edit.trim(long_walk, frames="0:3000")
    motion = retarget.to_robot(short, g1, progress=progress)
    assert {stage for stage, _, _ in reports} <= {"frames", "fit"} and reports
    assert all(0 <= done <= total for _, done, total in reports)
    assert thread == {threading.get_ident()}
    silent = retarget.to_robot(short, g1)
    assert silent.qpos.tobytes() == motion.qpos.tobytes()


def test_callback_exceptions_are_raised(long_walk: retarget.Clip, g1: retarget.Robot) -> None:
    def progress(stage: str, done: int, total: int) -> None:
        raise LookupError("enough")

    start = time.monotonic()
    with pytest.raises(LookupError, match="enough"):
        retarget.to_robot(long_walk, g1, progress=progress)
    assert time.monotonic() - start < 20


@pytest.mark.parametrize("method", ["gmr", "fit"])
def test_an_interrupt(method: str, long_walk: retarget.Clip, g1: retarget.Robot) -> None:
    # Long enough on any machine: the signal must arrive before the end.
    longer = retarget.edit.resample(long_walk, speed=0.4)
    timer = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        retarget.to_robot(longer, g1, method=method)
    assert time.monotonic() - start < 20
    timer.join()


def test_an_interrupt_of_a_reference(long_walk: retarget.Clip, g1: retarget.Robot) -> None:
    motion = retarget.to_robot(long_walk, g1, method="gmr")
    # Longer than the work, which takes several times this long on any machine.
    timer = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        motion.reference(1000)
        pytest.fail("the reference was finished")
    timer.join()


def test_a_thread_that_runs_at_exit_is_no_leak(data: Path) -> None:
    program = ("import retarget, sys, threading, time\n"
               "clip = retarget.load(sys.argv[1])\n"
               "threading.Thread(target=lambda: [time.sleep(0.01) for _ in iter(int, 1)],"
               " daemon=True).start()\n")
    done = subprocess.run([sys.executable, "-c", program, data / "walk.bvh"], capture_output=True,
                          text=True, check=True)
    assert done.stderr == ""


def test_an_interrupt_where_a_shell_runs_the_tests_in_the_background() -> None:
    """Such a shell ignores SIGINT, and so would Python and all that it starts."""
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider",
         f"{Path(__file__).resolve()}::test_an_interrupt"],
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN), text=True,
        capture_output=True, timeout=300)
    assert done.returncode == 0 and "2 passed" in done.stdout, done.stdout + done.stderr


def test_others_run_meanwhile(long_walk: retarget.Clip, g1: retarget.Robot) -> None:
    counted = 0
    stop = threading.Event()

    def count() -> None:
        nonlocal counted
        while not stop.is_set():
            counted += 1
            time.sleep(0.001)

    other = threading.Thread(target=count)
    other.start()
    retarget.to_robot(retarget.edit.trim(long_walk, frames="0:2000"), g1)
    stop.set()
    other.join()
    assert counted > 20


def test_a_batch(data: Path, tmp_path: Path, command) -> None:
    (tmp_path / "clips").mkdir()
    for name in ("walk", "squat"):
        (tmp_path / f"clips/{name}.bvh").write_bytes((data / f"{name}.bvh").read_bytes())
    (tmp_path / "clips/broken.bvh").write_text("HIERARCHY\n")
    result = retarget.batch(tmp_path / "clips", tmp_path / "python", "unitree_g1", method="gmr",
                            jobs=2)
    command("batch", tmp_path / "clips", "-o", tmp_path / "command", "--robot", "unitree_g1",
            "--method", "gmr", "--jobs", "2", code=1)
    for name in ("walk.csv", "squat.csv"):
        assert (tmp_path / "python" / name).read_bytes() == (
            tmp_path / "command" / name).read_bytes()
    assert result.failed == 1 and len(result.clips) == 3 and result.notes
    assert (tmp_path / "python/summary.csv").exists()
    again = retarget.batch([tmp_path / "clips"], tmp_path / "python", ["unitree_g1"], method="gmr",
                           resume=True)
    assert any("done and unchanged" in note for note in again.notes)
    with pytest.raises(retarget.UsageError, match="resume"):
        retarget.batch(tmp_path / "clips", tmp_path / "python", "g1", resume=True, redo=True)
    with pytest.raises(retarget.UsageError, match='did you mean "jobs"'):
        retarget.batch(tmp_path / "clips", tmp_path / "python", "g1", job=2)


def test_the_base_of_a_batch_is_the_robots(data: Path, tmp_path: Path) -> None:
    clip = tmp_path / "clips/a/walk.bvh"
    clip.parent.mkdir(parents=True)
    clip.write_bytes((data / "walk.bvh").read_bytes())
    options = {"method": "gmr", "end": 0.2}
    retarget.batch(clip, tmp_path / "held", "unitree_g1", base="fixed",
                   relative_to=tmp_path / "clips", **options)
    rows = (tmp_path / "held/a/walk.csv").read_text().splitlines()
    assert {tuple(map(float, row.split(",")[:7])) for row in rows} == {(0, 0, 0.793, 0, 0, 0, 1)}
    with pytest.raises(retarget.UsageError, match="base: expected one of auto, fixed"):
        retarget.batch(clip, tmp_path / "wrong", "unitree_g1", base="fxied", **options)


def test_an_interrupted_batch_goes_on_later(walk: retarget.Clip, tmp_path: Path) -> None:
    (tmp_path / "clips").mkdir()
    for number in range(6):
        retarget.edit.resample(walk, speed=0.1).save(tmp_path / f"clips/{number}.bvh", decimals=4)
    out = tmp_path / "out"
    options = {"method": "gmr", "jobs": 1}
    stopped: list[float] = []

    def finished() -> set[str]:
        text = (out / "manifest.jsonl").read_text() if (out / "manifest.jsonl").exists() else ""
        lines = map(json.loads, text.split("\n")[:-1])
        return {line["relative"] for line in lines if line["status"] == "done"}

    def interrupt() -> None:
        end = time.monotonic() + 60
        while not finished() and time.monotonic() < end:
            time.sleep(0.01)
        stopped.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    other = threading.Thread(target=interrupt)
    other.start()
    with pytest.raises(KeyboardInterrupt):
        retarget.batch(tmp_path / "clips", out, "unitree_g1", **options)
    other.join()
    assert time.monotonic() - stopped[0] < 20
    kept = {out / f"{Path(name).stem}.csv" for name in finished()}
    assert 0 < len(kept) < 6
    before = {file: (file.read_bytes(), file.stat().st_mtime_ns) for file in kept}
    done = retarget.batch(tmp_path / "clips", out, "unitree_g1", **options, resume=True)
    assert done.failed == 0
    assert {entry["relative"] for entry in done.clips} == {f"{number}.bvh" for number in range(6)}
    assert {file: (file.read_bytes(), file.stat().st_mtime_ns) for file in kept} == before
    assert len(list(out.glob("[0-9].csv"))) == 6
    assert not [file for file in (tmp_path / "out").rglob("*.tmp*")]


LEAKS = """
    import pickle, resource, sys
    import numpy as np
    import retarget

    data, calls, clips = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    robot = retarget.Robot("unitree_g1")

    def use(path):
        clip = retarget.load(path)
        motion = retarget.to_robot(clip, robot, method="gmr", end=0.5)
        report = retarget.evaluate(motion)
        made = retarget.Clip.from_arrays(clip.joint_names, clip.parents, clip.positions,
                                         rotations_wxyz=clip.rotations, fps=30)
        again = pickle.loads(pickle.dumps([clip, robot, motion]))[2]
        page = retarget.view(again)
        return (motion.joint_positions.sum() + made.positions.sum() + len(report.figures)
                + again.qpos.sum() + len(page.html))

    def call(number, clip, motion):
        arrays = [motion.qpos, motion.root_rotation_xyzw, motion.joint_positions, clip.positions]
        robot.forward_kinematics(motion.qpos[0])
        robot.forward_kinematics(motion.qpos[:2])
        arrays.append(retarget.Motion.from_qpos(motion[2:9].qpos, robot, 30).qpos)
        try:
            retarget.load("nowhere.bvh")
        except retarget.InputError:
            pass
        return sum(array[0].sum() for array in arrays)

    def peak():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

    clip = retarget.load(data + "/walk.bvh")
    motion = retarget.to_robot(clip, robot, method="gmr", end=0.5)
    for number in range(min(calls, 1000)):
        call(number, clip, motion)
    for number in range(min(clips, 20)):
        use(data + "/walk.bvh")
    before = peak()
    for number in range(calls):
        call(number, clip, motion)
    for number in range(clips):
        use(data + "/walk.bvh")
    print(f"{peak() - before:.1f} MB more after {calls} calls and {clips} clips: {peak():.0f} MB")
    sys.exit(peak() - before > 8)
"""


def test_nothing_leaks(data: Path) -> None:
    """Memory does not grow and nanobind counts no object that is left.

    RETARGET_PYTHON_CALLS and RETARGET_PYTHON_CLIPS say how many (docs/python.md has a long run).
    """
    calls = os.environ.get("RETARGET_PYTHON_CALLS", "500")
    clips = os.environ.get("RETARGET_PYTHON_CLIPS", "20")
    if os.environ.get("LD_PRELOAD"):
        pytest.skip("a sanitizer keeps freed memory")
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(LEAKS), str(data), calls, clips],
                          capture_output=True, text=True, check=False,
                          env={**os.environ, "RETARGET_REPORT_LEAKS": "1"})
    print(done.stdout)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "leak" not in done.stderr and done.stderr == ""


def test_a_batch_of_one_process_has_no_python_in_its_workers(data: Path, tmp_path: Path) -> None:
    """Threads that hold Python's lock must not matter to workers."""
    stop = threading.Event()
    busy = threading.Thread(target=lambda: [None for _ in iter(stop.is_set, True)])
    busy.start()
    try:
        result = retarget.batch(data / "walk.bvh", tmp_path / "out", "unitree_g1", method="gmr")
    finally:
        stop.set()
        busy.join()
    assert result.failed == 0
    [entry] = result.clips
    # A worker killed by a signal has an error.
    assert entry["status"] == "done" and "error" not in entry


def test_the_manifest_of_this_run_alone(data: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    # Unicode line separators, which are ordinary characters in JSON.
    odd = tmp_path / "walk\u2028\x85.bvh"
    odd.write_bytes((data / "walk.bvh").read_bytes())
    result = retarget.batch(odd, out, "unitree_g1", method="gmr", end=0.2)
    assert result.failed == 0 and [entry["relative"] for entry in result.clips] == [odd.name]
    with (out / "manifest.jsonl").open("a") as file:
        file.write('{"torn')
    # A manifest of another part.
    (out / "manifest.2-of-2.jsonl").write_text(json.dumps({"relative": "other"}) + "\n")
    again = retarget.batch(odd, out, "unitree_g1", method="gmr", end=0.2, resume=True)
    assert {entry["relative"] for entry in again.clips} == {odd.name}
    shard = retarget.batch([data / "walk.bvh", data / "squat.bvh"], tmp_path / "parts",
                           "unitree_g1", method="gmr", end=0.2, shard="1/2")
    assert len(shard.clips) == 1


def test_finalizers_may_call_the_engine_while_python_shuts_down(data: Path) -> None:
    program = """
        import sys
        import retarget

        class Late:
            def __del__(self):
                motion = self.to_robot(self.clip, self.robot)
                print(motion.frame_count, flush=True)

        late = Late()
        late.to_robot = retarget.to_robot
        late.clip, late.robot = retarget.load(sys.argv[1]), retarget.Robot("unitree_g1")
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(program),
                           str(data / "wave.bvh")], capture_output=True, text=True, check=False,
                          timeout=120)
    assert (done.returncode, done.stderr, int(done.stdout) > 0) == (0, "", True)


@pytest.mark.parametrize("call", [
    "retarget.to_robot(clip, robot)", "retarget.to_robot(clip, robot, method='gmr', fps=500)",
    "retarget.load(file)", "push(clip, robot)"])
def test_a_daemon_thread_does_not_abort_the_exit(call: str, data: Path) -> None:
    program = f"""
        import sys, threading, time
        import retarget

        def push(clip, robot):
            with retarget.live(clip, robot, fps=50, mode="lag") as session:
                for i in range(clip.frame_count):
                    session.push(clip.local_rotations_wxyz[i], clip.local_positions[i])

        def work():
            while True:
                {call}
                started.set()

        file = sys.argv[1]
        clip, robot = retarget.load(file), retarget.Robot("unitree_g1")
        started = threading.Event()
        threading.Thread(target=work, daemon=True).start()
        started.wait()
        time.sleep(0.02)
    """
    for _ in range(3):
        done = subprocess.run([sys.executable, "-c", textwrap.dedent(program),
                               str(data / "wave.bvh")], capture_output=True, text=True,
                              check=False, timeout=120)
        assert (done.returncode, done.stderr) == (0, "")


def test_a_loaded_robot_in_a_batch(data: Path, tmp_path: Path) -> None:
    robot = retarget.Robot("g1", dof="23")
    options = {"method": "gmr", "end": 0.2, "quality": False}
    made = retarget.batch(data / "wave.bvh", tmp_path / "a", robot, **options)
    same = retarget.batch(data / "wave.bvh", tmp_path / "b", "g1", dof="23", **options)
    assert made.failed == same.failed == 0
    assert (tmp_path / "a/wave.csv").read_bytes() == (tmp_path / "b/wave.csv").read_bytes()
    with pytest.raises(retarget.UsageError, match="dof is an option of Robot"):
        retarget.batch(data / "wave.bvh", tmp_path / "c", robot, dof="23", **options)
    with pytest.raises(TypeError, match="robots: expected a path or several, found int"):
        retarget.batch(data / "wave.bvh", tmp_path / "c", 5)


def test_a_loaded_robot_keeps_its_data_folder(data: Path, tmp_path: Path) -> None:
    root = data.parent
    folder = tmp_path / "folder"
    shutil.copytree(root / "configs", folder / "configs")
    # The copy has the G1 under another name, which no other data folder has.
    shutil.copytree(root / "robots/unitree_g1", folder / "robots/only_here")
    robot = retarget.Robot("only_here", data_dir=folder)
    retarget.batch([data / "wave.bvh"], tmp_path / "out", robot, jobs=1, method="gmr")
    assert (tmp_path / "out/wave.csv").is_file()
    written = retarget.convert(tmp_path / "out/wave.csv", tmp_path / "wave.pkl", robot,
                               format="pkl-gmr")
    assert written == [tmp_path / "wave.pkl"]
    with pytest.raises(retarget.Error, match="only_here"):
        retarget.batch([data / "wave.bvh"], tmp_path / "other", "only_here", jobs=1, method="gmr")
