#!/usr/bin/env python3
"""Times a Python loop over the frames of a clip: retarget.gmr's class compared with the published
method.

The loop runs in one process and one thread, with interleaved repetitions. Every peer gets loaded
frames and returns a configuration per frame; none writes a file. The peers:

  retarget    retarget.gmr.GeneralMotionRetargeting.retarget
  python      the Python reference (retarget_oracle.py on mink, MuJoCo and DAQP). Its targets are made
              before the clock starts, so its loop contains only the inverse kinematics
  published   general_motion_retargeting's own class, if that package is installed

Prints JSON, which bench/compare_peers displays.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import pathlib
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

Loop = Callable[[int], Any]  # Solves the first n frames and returns their configurations.


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("bvh", type=pathlib.Path)
    parser.add_argument("--shared", type=pathlib.Path, required=True,
                        help="the folder with oracle/ and reference/")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--no-peer", action="store_true", help="retarget alone")
    parser.add_argument("--frames", type=int, help="of the peers that are not ours (default: all)")
    return parser.parse_args()


def class_loop(make: Callable[[], Any], frames: Sequence[Any]) -> Loop:
    def loop(count: int) -> list[Any]:
        retargeter = make()
        start = time.perf_counter()
        found = [retargeter.retarget(frame) for frame in frames[:count]]
        loop.seconds = time.perf_counter() - start  # type: ignore[attr-defined]
        return found
    return loop


def our_loop(bvh: pathlib.Path) -> tuple[Loop, int]:
    from retarget.gmr import GeneralMotionRetargeting
    from retarget.gmr.utils.lafan1 import load_bvh_file
    frames, height = load_bvh_file(bvh)
    return class_loop(lambda: GeneralMotionRetargeting(
        "bvh_lafan1", "unitree_g1", height, verbose=False), frames), len(frames)


def reference_loop(bvh: pathlib.Path, shared: pathlib.Path) -> Loop:
    spec = importlib.util.spec_from_file_location("oracle", shared / "oracle/retarget_oracle.py")
    assert spec is not None and spec.loader is not None
    oracle = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(oracle)
    import mujoco
    robot = shared / "reference/robots/unitree_g1/g1_mocap_29dof.xml"
    model = mujoco.MjModel.from_xml_string(oracle.kinematic_mjcf(str(robot)))
    config = json.loads((shared / "reference/ik_configs/bvh_to_g1.json").read_text())
    targets = oracle.make_targets(oracle.world_bones(oracle.read_bvh(str(bvh))), config, 1.75)

    def loop(count: int) -> Any:
        start = time.perf_counter()
        qpos, _ = oracle.retarget(model, config, targets, count)
        loop.seconds = time.perf_counter() - start  # type: ignore[attr-defined]
        return qpos[:, -1]
    return loop


def published_loop(bvh: pathlib.Path) -> Loop:
    from general_motion_retargeting import GeneralMotionRetargeting  # type: ignore
    from retarget.gmr.utils.lafan1 import load_bvh_file
    frames, height = load_bvh_file(bvh)
    return class_loop(lambda: GeneralMotionRetargeting(
        "bvh_lafan1", "unitree_g1", height, verbose=False), frames)


def difference(ours: Sequence[Any], other: Sequence[Any]) -> float:
    """Returns the largest difference of any value in any frame, for either sign of quaternions."""
    import numpy as np
    a, b = np.array(ours)[:len(other)], np.array(other)[:len(ours)]
    signs = np.sign(np.sum(a[:, 3:7] * b[:, 3:7], axis=1, keepdims=True))
    b[:, 3:7] *= signs
    return float(np.abs(a - b).max())


def main() -> None:
    options = arguments()
    loops: dict[str, Loop] = {}
    missing: dict[str, str] = {}
    loops["retarget"], count = our_loop(options.bvh)
    peers = {"python": lambda: reference_loop(options.bvh, options.shared),
             "published": lambda: published_loop(options.bvh)}
    for name, make in () if options.no_peer else peers.items():
        try:
            loops[name] = make()
        except (ImportError, OSError) as error:
            missing[name] = str(error)
    rates: dict[str, list[float]] = {name: [] for name in loops}
    results: dict[str, Any] = {}
    for _ in range(options.repetitions):
        for name, loop in loops.items():
            frames = count if name == "retarget" else min(count, options.frames or count)
            results[name] = loop(frames)
            rates[name].append(frames / loop.seconds)  # type: ignore[attr-defined]
    report = {
        "frames": count,
        "missing": missing,
        "frames_per_s": rates,
        "ratios": {name: [a / b for a, b in zip(rates["retarget"], rates[name])]
                   for name in loops if name != "retarget"},
        "largest_difference": {name: difference(results["retarget"], results[name])
                               for name in loops if name != "retarget"},
        "median": {name: statistics.median(values) for name, values in rates.items()}}
    json.dump(report, sys.stdout)
    print()


if __name__ == "__main__":
    main()
