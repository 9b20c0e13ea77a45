"""Retargets human frames as they arrive, and computes the robot's configuration for each at once.

    python 03_live.py data/walk.bvh unitree_g1

A file replaces the tracker here. Frames have the format of the published class
GeneralMotionRetargeting (docs/migrating_from_gmr.md): {body: (position, quaternion w x y z)}, metres,
Z up. Each solve starts from the previous frame, without look-ahead: the method is `gmr`.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator

import numpy as np

from retarget.gmr import GeneralMotionRetargeting
from retarget.gmr.utils.lafan1 import load_bvh_file


def frames_of(file: str) -> tuple[Iterator[dict], float]:
    """Returns frames like a tracker's, and the body's height, metres."""
    frames, height = load_bvh_file(file)
    return iter(frames), height


def main(file: str, robot: str) -> None:
    frames, height = frames_of(file)
    retargeter = GeneralMotionRetargeting("bvh_lafan1", robot, actual_human_height=height,
                                          verbose=False)
    times = []
    for frame in frames:
        start = time.perf_counter()
        qpos = retargeter.retarget(frame)
        times.append(time.perf_counter() - start)
        # Send the joints to the robot's controller or the simulator here.
        assert np.isfinite(qpos).all()
    print(f"{len(times)} frames, {1e6 * np.median(times):.0f} us each, "
          f"the slowest {1e6 * max(times):.0f} us; the pelvis ended at {qpos[:3].round(3)}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
