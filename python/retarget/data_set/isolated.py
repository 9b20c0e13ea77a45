"""Solves the clips of a folder in a separate process: python -m retarget.data_set.isolated FILE.

FILE is a pickle that solve.py wrote: keyword arguments of retarget.batch(). The process ends with
its parent, and so do the workers of the batch.
"""

from __future__ import annotations

import ctypes
import os
import pickle
import signal
import sys
import warnings
from pathlib import Path

import retarget

ERROR = "error.pickle"
_PR_SET_PDEATHSIG = 1


def end_with(parent: int) -> None:
    """Lets Linux kill this process when its parent ends, however it ends."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def main() -> None:
    request = Path(sys.argv[1])
    parent, arguments = pickle.loads(request.read_bytes())
    end_with(parent)
    # The manifest already lists each clip's warnings.
    warnings.simplefilter("ignore", retarget.RetargetWarning)
    try:
        retarget.batch(**arguments)
    except retarget.Error as error:
        request.with_name(ERROR).write_bytes(pickle.dumps(error))
        sys.exit(1)


if __name__ == "__main__":
    main()
