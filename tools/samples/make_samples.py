#!/usr/bin/env python3
"""Writes the synthetic sample motions as BVH files (LAFAN1-shaped skeleton, y up, centimetres).

    make_samples.py -o data/              the committed clips at 30 frames per second
    make_samples.py --check data/         regenerates them and compares the bytes
    make_samples.py --only jump --fps 60 -o out/
    make_samples.py --all -o out/         every motion, the stress tests too
"""

import argparse
import pathlib
import sys
from collections.abc import Callable

from bvh_writer import bvh_text
from gait import Motion, run, turn_in_place, walk
from pose import solve
import actions
import floor_actions

COMMITTED: dict[str, Callable[[], Motion]] = {
    "walk": walk,
    "turn_in_place": turn_in_place,
    "squat": actions.squat,
    "wave": actions.wave,
    "get_up": floor_actions.get_up,
}
FURTHER: dict[str, Callable[[], Motion]] = {
    "jump": actions.jump,
    "run": run,
    "crawl": floor_actions.crawl,
    "sit": actions.sit,
    "stand_still": actions.stand_still,
    "cartwheel": floor_actions.cartwheel,
    "one_frame": actions.stand_still,
    "two_frames": actions.stand_still,
}
FIXED_FRAMES = {"one_frame": 1, "two_frames": 2}


def clip_text(name: str, fps: int, duration: float | None) -> str:
    """The BVH file of a motion: samples at i / fps, both ends included."""
    motion = (COMMITTED | FURTHER)[name]()
    length = motion.duration if duration is None else duration
    # The small term keeps a duration such as 5.1 s at 30 fps from losing its last frame to rounding.
    frames = FIXED_FRAMES.get(name, int(length * fps + 1e-6) + 1)
    return bvh_text([solve(motion.pose(i / fps)) for i in range(frames)], 1.0 / fps)


def check(name: str, text: str, folder: pathlib.Path) -> bool:
    """Whether the file in `folder` has exactly these bytes; says where it does not."""
    path = folder / f"{name}.bvh"
    if not path.is_file():
        print(f"{path}: missing", file=sys.stderr)
        return False
    have, want = path.read_bytes(), text.encode("ascii")
    if have == want:
        print(f"{path}: identical")
        return True
    rows = zip(have.split(b"\n"), want.split(b"\n"))
    line = next((i for i, (a, b) in enumerate(rows, 1) if a != b), min(have.count(b"\n"), want.count(b"\n")) + 1)
    print(f"{path}:{line}: differs from what is generated", file=sys.stderr)
    return False


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=pathlib.Path, help="folder to write to (made if missing)")
    parser.add_argument("--check", type=pathlib.Path, metavar="FOLDER", help="compare with the files in FOLDER, write nothing")
    parser.add_argument("--only", action="append", metavar="NAME", help="only this motion (may be repeated)")
    parser.add_argument("--all", action="store_true", help="the motions outside the committed set too")
    parser.add_argument("--list", action="store_true", help="list the motions and stop")
    parser.add_argument("--fps", type=int, default=30, help="frames per second (default 30)")
    parser.add_argument("--duration", type=float, help="seconds, instead of the motion's own; the end pose is held")
    args = parser.parse_args()
    known = COMMITTED | FURTHER
    if args.list:
        for name in known:
            print(f"{name:14} {'' if name in COMMITTED else '(with --all or --only)'}".rstrip())
        return 0
    for name in args.only or []:
        if name not in known:
            parser.error(f"unknown motion {name}; --list names them")
    if args.fps <= 0:
        parser.error("--fps must be positive")
    if args.duration is not None and args.duration < 0:
        parser.error("--duration must not be negative")
    if (args.output is None) == (args.check is None):
        parser.error("give either -o FOLDER or --check FOLDER")
    names = args.only or list(known if args.all else COMMITTED)
    texts = {name: clip_text(name, args.fps, args.duration) for name in names}
    if args.check is not None:
        return 0 if all([check(name, text, args.check) for name, text in texts.items()]) else 1
    args.output.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        (args.output / f"{name}.bvh").write_bytes(text.encode("ascii"))
        print(args.output / f"{name}.bvh")
    return 0


if __name__ == "__main__":
    sys.exit(main())
