"""Packs the passed motions of a batch: python -m retarget.packs lerobot out/ set/ --robot g1."""

from __future__ import annotations

import argparse
import sys

import retarget
from retarget import packs


def main(arguments: list[str] | None = None) -> int:
    """Runs the command; returns its exit code: 0, or 1 after an error, which it prints."""
    parser = argparse.ArgumentParser(prog="python -m retarget.packs", description=__doc__)
    parser.add_argument("kind", choices=["lerobot", "motion_v1", "webdataset"])
    parser.add_argument("batch", help="output folder of retarget batch, with passed.txt")
    parser.add_argument("output", help="new folder")
    parser.add_argument("--robot", help="robot of the motions to take")
    parser.add_argument("--ending", help="end of the files to take, such as .mjlab.npz")
    parser.add_argument("--max-bytes", type=int, help="largest size of a part; not for motion_v1")
    parser.add_argument("--max-clips", type=int, help="largest number of clips in a part")
    parser.add_argument("--end-effectors", nargs="+", metavar="BODY",
                        help="bodies whose poses motion_v1 stores (default: the wrists of the G1)")
    parser.add_argument("--replace", action="store_true", help="replace an earlier pack")
    given = {name: value for name, value in vars(parser.parse_args(arguments)).items()
             if value is not None}
    write = getattr(packs, f"write_{given.pop('kind')}")
    unknown = given.keys() - {"batch", "ending", "output", "robot"} - set(write.__kwdefaults__)
    if unknown:
        parser.error(f"--{min(unknown).replace('_', '-')} is not an option of this kind")
    try:
        robot = given.get("robot")
        clips = packs.clips_of(given.pop("batch"), given.pop("ending", None), robot)
        robots = sorted(set(clips.robots.values()))
        if robot is None and len(robots) > 1:
            raise retarget.UsageError(f"the batch has motions of {', '.join(robots)}; --robot takes "
                                      "those of one")
        if clips.left_out:
            others = ", ".join(sorted(set(clips.left_out.values())))
            count = len(clips.left_out)
            print(f"left out {count} motion{'s' if count > 1 else ''} of other robots: {others}",
                  file=sys.stderr)
        if "robot" not in write.__kwdefaults__:
            given.pop("robot", None)
        write(clips, given.pop("output"), **given)
    except retarget.Error as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
