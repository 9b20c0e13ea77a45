"""Streams: serve and play give the bytes of the command `retarget live`."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import retarget


def received(server: retarget.Server, count: int) -> None:
    """Waits until a stream has arrived."""
    deadline = time.monotonic() + 30
    while sum(1 for _ in open(server.file)) < count:
        assert server.running and time.monotonic() < deadline, server.messages
        time.sleep(0.01)


@pytest.fixture
def take(data: Path, tmp_path: Path) -> tuple[Path, retarget.Server]:
    """A recorded stream of a walk, and its ended server."""
    with retarget.serve("unitree_g1", input="udp:0?format=bvh", output=tmp_path / "frames.csv",
                        record=tmp_path / "take", skeleton=data / "walk.bvh", fps=50) as server:
        server.file = tmp_path / "frames.csv"
        assert server.running and not server.summary and server.wait(0.01) is None
        assert server.address.startswith("udp:127.0.0.1:") and server.address.endswith("?format=bvh")
        assert retarget.play(data / "walk.bvh", server.address, speed=10) == 301
        received(server, 40)
    return tmp_path / "take", server


def test_a_recording_gives_the_command_s_bytes(take: tuple[Path, retarget.Server], command,
                                               tmp_path: Path) -> None:
    folder, server = take
    assert not server.running
    assert server.stop() is server.summary and server.summary["packets"] >= 100
    frames = (tmp_path / "frames.csv").read_bytes()
    assert server.summary["outputs"][0]["sent"] == server.summary["robot_frames"] == frames.count(b"\n")
    assert any(line.startswith("packets: ") for line in server.messages)
    replayed = retarget.serve(replay=folder, output=[tmp_path / "again.csv"])
    assert replayed.wait()["robot_frames"] == server.summary["robot_frames"]
    assert (tmp_path / "again.csv").read_bytes() == frames
    command("live", "--replay", folder, "-o", tmp_path / "command.csv")
    assert (tmp_path / "command.csv").read_bytes() == frames


def test_messages_begin_with_what_loading_the_robot_says(data: Path, tmp_path: Path) -> None:
    with retarget.serve("g1", input="udp:0?format=bvh", output=tmp_path / "frames.csv",
                        skeleton=data / "walk.bvh") as server:
        assert server.messages[0] == 'robot: "g1" is unitree_g1'


def test_a_recording_of_the_command_is_replayed(data: Path, tool: str, command,
                                                tmp_path: Path) -> None:
    stream = command("live", "--play", data / "wave.bvh", "--to", "stdout", "--speed", 0).stdout
    environment = {key: value for key, value in os.environ.items() if key != "LD_PRELOAD"}
    subprocess.run([tool, "live", "--robot", "g1", "--record", tmp_path / "take", "-o", tmp_path / "a.csv"],
                   input=stream, text=True, check=True, capture_output=True, timeout=120,
                   env=environment)
    summary = retarget.serve(replay=tmp_path / "take", output=tmp_path / "b.csv").wait()
    assert summary["robot_frames"] > 100
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_a_run_ends_by_itself(tmp_path: Path) -> None:
    began = time.monotonic()
    server = retarget.serve("g1", input="udp:0?format=bvh", output=tmp_path / "out.csv", seconds=0.2)
    assert server.wait(30)["robot_frames"] == 0
    assert 0.15 < time.monotonic() - began < 20 and repr(server) == "<retarget.Server: over>"


def test_errors(data: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    with pytest.raises(retarget.UsageError, match="input: expected an address"):
        retarget.serve("g1", output=out)
    with pytest.raises(retarget.UsageError, match="output: expected an address"):
        retarget.serve("g1", input="udp:0")
    with pytest.raises(retarget.UsageError, match="needs a robot: robot NAME or robot_xml FILE"):
        retarget.serve(input="udp:0", output=out)
    with pytest.raises(retarget.UsageError, match="record and replay cannot be combined"):
        retarget.serve("g1", input="udp:0", output=out, record=tmp_path / "a", replay=made_take(tmp_path))
    with pytest.raises(TypeError, match="skeleton"):
        retarget.serve("g1", input="udp:0", output=out, skeletn="walk.bvh")
    with pytest.raises(retarget.ConfigError):
        retarget.serve("nosuch", input="udp:0", output=out)
    with retarget.serve("g1", input="udp:0?format=bvh", output=out) as server:
        port = server.address.partition("?")[0].rpartition(":")[2]
        with pytest.raises(retarget.RunError):
            retarget.serve("g1", input=f"udp:{port}?format=bvh", output=tmp_path / "b.csv")
    with pytest.raises(retarget.UsageError):
        retarget.play(data / "walk.bvh", "udp:door")
    with pytest.raises(retarget.UsageError, match="speed"):
        retarget.play(data / "walk.bvh", "udp:9", speed=-1)


def made_take(folder: Path) -> Path:
    take = folder / "take"
    take.mkdir()
    (take / "live.json").write_text("{}")
    return take


def test_an_exception_ends_the_run(tmp_path: Path) -> None:
    with pytest.raises(KeyError):
        with retarget.serve("g1", input="udp:0", output=tmp_path / "out.csv") as server:
            raise KeyError("x")
    assert not server.running


def test_a_forgotten_server_ends_with_the_program(tmp_path: Path) -> None:
    code = ("import sys, retarget; retarget.serve('g1', input='udp:0', output=sys.argv[1])\n"
            "print('end')")
    done = subprocess.run([sys.executable, "-c", code, tmp_path / "out.csv"], text=True,
                          capture_output=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (0, "end\n", "")


def test_ctrl_c_stops_a_player(data: Path) -> None:
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        retarget.play(data / "walk.bvh", "udp:9?format=lines", speed=0.1)
    timer.join()
    assert time.monotonic() - began < 10
