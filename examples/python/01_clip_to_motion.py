"""Retargets one clip, plots its joints and saves it for training.

    python 01_clip_to_motion.py data/walk.bvh unitree_g1 out/
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import retarget


def plot_joints(motion: retarget.Motion, file: Path, count: int = 6) -> bool:
    """Plots the joints that move most, with their limits; returns False without matplotlib."""
    try:
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
    except ImportError:
        return False
    times = np.arange(len(motion)) / motion.fps
    limits = motion.robot.joint_limits()
    moving = np.argsort(-np.ptp(motion.joint_positions, axis=0))[:count]
    figure, axes = plt.subplots(count, sharex=True, figsize=(8, 1.5 * count), squeeze=False)
    for axis, joint in zip(axes[:, 0], moving):
        axis.plot(times, motion.joint_positions[:, joint])
        axis.axhspan(*limits[joint], alpha=0.1)
        axis.set_ylabel("rad")
        axis.set_title(motion.joint_names[joint], fontsize="small")
    axes[-1, 0].set_xlabel("s")
    figure.tight_layout()
    figure.savefig(file)
    return True


def main(bvh: str, robot: str, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    clip = retarget.load(bvh)
    motion = retarget.to_robot(clip, robot)
    print(clip, motion, motion.summary, sep="\n")

    report = retarget.evaluate(motion)
    print(report.missed or "all gates passed")
    print("fastest joint:", report.figures["peak_speed"], "rad/s")

    stem = folder / Path(bvh).stem
    motion.save(f"{stem}.csv")
    # A tracking NPZ runs at 50 fps: solving at this rate is better than interpolating the motion of 30 fps.
    for_training = retarget.to_robot(clip, robot, format="npz-mjlab")
    for_training.save(f"{stem}.npz", format="npz-mjlab")
    if not plot_joints(motion, Path(f"{stem}.png")):
        print("no picture: pip install matplotlib")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], Path(sys.argv[3]))
