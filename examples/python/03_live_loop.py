"""A human frame by frame to a robot, as in teleoperation, at the rate of the source.

    python 03_live_loop.py walk.bvh unitree_g1 walk.npy

A file stands for the stream here: put your own source of frames in place of stream(). Each frame is
solved from the one before, in well under a millisecond, so every stream has a retargeter of its own.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator

import numpy as np

import retarget
from retarget.gmr import GeneralMotionRetargeting
from retarget.gmr.utils.lafan1 import load_bvh_file

FPS = 30.0


def stream(file: str) -> Iterator[dict]:
    """{body: (position, metres, Z up; quaternion w x y z)}, FPS times a second."""
    frames, _ = load_bvh_file(file)
    start = time.perf_counter()
    for number, frame in enumerate(frames):
        time.sleep(max(0.0, start + number / FPS - time.perf_counter()))
        yield frame


def main(file: str, robot: str, output: str) -> None:
    retargeter = GeneralMotionRetargeting("bvh_lafan1", robot, actual_human_height=1.75,
                                          verbose=False)
    rows, seconds = [], []
    for frame in stream(file):
        before = time.perf_counter()
        try:
            qpos = retargeter.retarget(frame, offset_to_ground=False)
        except retarget.Error as error:  # a bad frame: the robot holds still
            print(error, file=sys.stderr)
            qpos = retargeter.qpos
        seconds.append(time.perf_counter() - before)
        rows.append(qpos)  # x y z, w x y z, joints: send them to the robot here
    np.save(output, rows)
    print(f"{len(rows)} frames, {1e6 * np.median(seconds):.0f} us each, "
          f"{1e6 * np.max(seconds):.0f} us at most")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
