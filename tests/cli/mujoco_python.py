"""MuJoCo's own Python, none of this project's code, as tools/setup.sh installs it with the library."""

import os
import pathlib
import sys

from tool import SOURCE, absent


def load_mujoco():
    """Returns the module; skips the test if it is missing."""
    folders = [SOURCE / "build/deps"]
    if os.environ.get("MuJoCo_ROOT"):
        folders.insert(0, pathlib.Path(os.environ["MuJoCo_ROOT"]).parent)
    sys.path.extend(str(folder) for folder in folders)
    try:
        import mujoco
    except ImportError as error:
        absent(f"this Python has no mujoco ({error})")
    finally:
        del sys.path[-len(folders) :]
    return mujoco
