"""Libraries that only some tests need."""

from __future__ import annotations

import importlib
import os
from pathlib import Path
from types import ModuleType

import pytest


LIBRARIES = Path(__file__).resolve().parents[2] / "build/deps"


def need(name: str, installed_by_setup: bool = True, folder: str = "data_sets") -> ModuleType:
    """Returns a module, or skips the test.

    In the strict mode of CI (RETARGET_STRICT_TESTS) a missing module is an error if tools/setup.sh
    --python could fetch the libraries of its folder in build/deps.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        message = f"{name} is not installed ({error})"
        strict = os.environ.get("RETARGET_STRICT_TESTS", "0") not in ("", "0")
        if installed_by_setup and strict and (LIBRARIES / folder).is_dir():
            raise AssertionError(f"{message}: tools/setup.sh --python installs it") from error
        pytest.skip(message)
