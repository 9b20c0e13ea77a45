"""Support for tests of the browser page: the built page, and runs of its engine in Node."""

import json
import os
import pathlib
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests/cli"))

from tool import NODE, TOOL  # noqa: E402  (found by the line before)

BUILD = pathlib.Path(os.environ.get("RETARGET_BROWSER", SOURCE / "build/wasm"))
ENGINE, DATA, PAGE = BUILD / "retarget.wasm", BUILD / "page/data.bundle", BUILD / "page/retarget.html"


def need_page():
    """Skips a test without the page, which standard builds do not make."""
    if not (ENGINE.is_file() and PAGE.is_file()):
        raise unittest.SkipTest("there is no browser page: tools/browser.sh builds it")


def run_engine(options, output, *files):
    """Runs the engine in Node. Returns the finished process; its output is the seconds of the run."""
    return subprocess.run(
        [NODE, SOURCE / "browser/run_engine.mjs", ENGINE, DATA, json.dumps(options), output, *files],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


def run_native(*arguments):
    """Runs the native tool on one thread."""
    return subprocess.run(
        [TOOL, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
        env={**os.environ, "RETARGET_DATA_DIR": str(SOURCE)},
    )
