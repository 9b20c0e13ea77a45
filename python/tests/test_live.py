"""Live sessions: invalid times, jumps of the clock, and options without an effect."""

from __future__ import annotations

import math
import time
from pathlib import Path

import pytest

import retarget


def first_frame(walk: retarget.Clip) -> tuple:
    return walk.local_rotations_wxyz[0], walk.local_positions[0]


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, 1e300])
def test_times_must_be_finite(walk: retarget.Clip, g1: retarget.Robot, wrong: float) -> None:
    with retarget.live(walk, g1) as session:
        assert len(session.push(*first_frame(walk), now=0.0)) == 1
        with pytest.raises(retarget.UsageError, match="now: expected a finite number"):
            session.pull(now=wrong)
        with pytest.raises(retarget.UsageError, match="now: expected a finite number"):
            session.push(*first_frame(walk), now=wrong)
        with pytest.raises(retarget.UsageError, match="time: expected a finite number"):
            session.push(*first_frame(walk), time=wrong, now=0.1)
        assert session.statistics["received"] == 1 and session.statistics["missed"] == 0


@pytest.mark.parametrize("wrong", ["x", [1.0, 2.0], 10**400])
def test_times_must_be_numbers(walk: retarget.Clip, g1: retarget.Robot, wrong: object) -> None:
    with retarget.live(walk, g1) as session:
        with pytest.raises(retarget.UsageError, match="time: expected a number, found"):
            session.push(*first_frame(walk), time=wrong, now=0.0)
        with pytest.raises(retarget.UsageError, match="now: expected a number, found"):
            session.pull(now=wrong)


@pytest.mark.parametrize("moment", [1e3, 1e5, 1.7e9, 9e11])
def test_a_jump_of_the_callers_clock_is_no_burst(walk: retarget.Clip, g1: retarget.Robot,
                                                moment: float) -> None:
    with retarget.live(walk, g1, fps=50) as session:
        session.push(*first_frame(walk), now=0.0)
        began = time.process_time()
        assert len(session.pull(now=moment)) <= 2
        assert time.process_time() - began < 5.0
        assert session.statistics["missed"] == pytest.approx(50 * moment, rel=1e-3)
        # The stream continues.
        assert len(session.push(*first_frame(walk), now=moment + 1.0)) >= 40


def test_a_gap_of_a_recording_is_filled(walk: retarget.Clip, g1: retarget.Robot) -> None:
    with retarget.live(walk, g1, fps=50) as session:
        session.push(*first_frame(walk), now=0.0)
        frames = session.pull(now=5.0)
        assert len(frames) >= 249 and frames[-1].state == "standing"
        assert session.statistics["missed"] == 0


def test_a_pause_of_the_program_is_no_burst(walk: retarget.Clip, g1: retarget.Robot) -> None:
    with retarget.live(walk, g1, fps=1000) as session:
        session.push(*first_frame(walk))
        time.sleep(1.2)
        assert len(session.pull()) < 1000
        assert session.statistics["missed"] >= 1000


def test_plain_follows_without_limits(walk: retarget.Clip, g1: retarget.Robot) -> None:
    def root_heights(**options: bool) -> list[float]:
        with retarget.live(walk, g1, fps=walk.fps, method="gmr", **options) as session:
            frames = []
            for i in range(60):
                now = i / walk.fps
                frames += session.push(walk.local_rotations_wxyz[i], walk.local_positions[i],
                                       time=now, now=now)
        return [frame.qpos[2] for frame in frames]

    offline = retarget.to_robot(walk, g1, method="gmr", fps="source")
    assert root_heights(plain=True) == pytest.approx(offline.root_position[:60, 2], abs=1e-9)
    assert root_heights() != pytest.approx(offline.root_position[:60, 2], abs=1e-9)


def test_options_without_an_effect(walk: retarget.Clip, g1: retarget.Robot, data: Path,
                                   tmp_path: Path) -> None:
    with pytest.raises(retarget.UsageError, match="lag requires mode lag"):
        retarget.live(walk, g1, lag=0.2)
    with pytest.raises(retarget.UsageError, match="without requires mode lag"):
        retarget.live(walk, g1, without="floor")
    with retarget.live(walk, g1, lag=0.1, mode="lag", without="floor") as session:
        assert session.state == "waiting"
    with retarget.live(walk, g1, lag=None, without=None) as session:
        assert session.state == "waiting"
    out = tmp_path / "out.csv"
    for wrong, text in (({"lag": 0.1}, "lag requires mode lag"),
                        ({"after": 2.0}, "after requires calibrate")):
        with pytest.raises(retarget.UsageError, match=text):
            retarget.serve("g1", input="udp:0", output=out, **wrong)
    with pytest.raises(retarget.ConfigError, match="nope"):
        retarget.serve("g1", input="udp:0", output=out, map="nope")
    assert not out.exists()
    with retarget.serve("g1", input="udp:0", output=out, lag=0.1, mode="lag", fps=50) as server:
        assert server.running


def test_a_replay_has_the_options_of_the_recording(tmp_path: Path) -> None:
    take = tmp_path / "take"
    take.mkdir()
    (take / "live.json").write_text('{"robot": "unitree_g1"}')
    (take / "input.stream").write_text("")
    out = tmp_path / "out.csv"
    for robot, given, text in (("g1", {}, "omit robot"), (None, {"fps": 30}, "omit fps"),
                               (None, {"mode": "frame"}, "omit mode")):
        with pytest.raises(retarget.UsageError, match=text):
            retarget.serve(robot, replay=take, output=out, **given)
    assert not out.exists()
    assert retarget.serve(replay=take, output=out).wait()["robot_frames"] == 0
