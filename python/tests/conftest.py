"""Fixtures of the package tests."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import pytest

import retarget

SOURCE = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session", autouse=True)
def interrupts() -> None:
    """Restores Python's SIGINT handler, which is missing in background jobs of a shell."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def data() -> Path:
    """The synthetic samples."""
    return SOURCE / "data"


@pytest.fixture(scope="session")
def g1() -> retarget.Robot:
    return retarget.Robot("unitree_g1")


@pytest.fixture(scope="session")
def walk(data: Path) -> retarget.Clip:
    return retarget.load(data / "walk.bvh")


@pytest.fixture(scope="session")
def walked(walk: retarget.Clip, g1: retarget.Robot) -> retarget.Motion:
    """The default method's motion."""
    return retarget.to_robot(walk, g1)


@pytest.fixture(scope="session")
def tool() -> str:
    """Returns the command: RETARGET_TOOL, otherwise the package's."""
    program = os.environ.get("RETARGET_TOOL") or Path(retarget.__file__).parent / "bin/retarget"
    if not Path(program).exists():
        pytest.skip("the command was not built")
    return str(program)


@pytest.fixture(scope="session")
def command(tool: str):
    """Runs the command without its messages."""

    def run(*arguments: object, code: int = 0) -> subprocess.CompletedProcess[str]:
        # Only the module needs the sanitizer library.
        environment = {k: v for k, v in os.environ.items() if k != "LD_PRELOAD"}
        done = subprocess.run([tool, *map(str, arguments)], text=True, capture_output=True,
                              env=environment, timeout=300)
        assert done.returncode == code, done.stderr
        return done

    return run
