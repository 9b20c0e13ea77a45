"""Retargets a folder of clips and their mirror images, first in threads, then as a batch.

    python 02_folder.py data/ unitree_g1 out/

Threads share the robot and the process. retarget.batch() starts a process for each clip, so it can
limit memory and time per clip; it also resumes and writes a manifest. Both use all processors.
"""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import retarget


def main(source: Path, name: str, folder: Path) -> None:
    robot = retarget.Robot(name)
    folder.mkdir(parents=True, exist_ok=True)

    def convert(file: Path) -> str:
        try:
            clip = retarget.load(file)
            for suffix, each in (("", clip), ("_mirrored", retarget.edit.mirror(clip))):
                motion = retarget.to_robot(each, robot, threads=1, format="npz-mjlab")
                motion.save(folder / f"{file.stem}{suffix}.npz", format="npz-mjlab")
            return f"{file.name}: {'good' if retarget.evaluate(motion).passed else 'misses gates'}"
        except retarget.Error as error:
            return str(error)

    with ThreadPoolExecutor() as pool:
        for line in pool.map(convert, sorted(source.glob("*.bvh"))):
            print(line)

    batch = retarget.batch(source, folder / "batch", name, method="gmr", redo=True)
    print(batch, *batch.notes[-1:], sep="\n")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))
