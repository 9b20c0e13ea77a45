"""Libraries that only some tests need."""

from __future__ import annotations

import importlib
import os
from types import ModuleType

import pytest


def need(name: str, installed_by_setup: bool = True) -> ModuleType:
    """Returns a module, or skips the test.

    In the strict mode of CI (RETARGET_STRICT_TESTS) a missing module that tools/setup.sh --python
    installs is an error.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        message = f"{name} is not installed ({error})"
        if installed_by_setup and os.environ.get("RETARGET_STRICT_TESTS", "0") not in ("", "0"):
            raise AssertionError(f"{message}: tools/setup.sh --python installs it") from error
        pytest.skip(message)
