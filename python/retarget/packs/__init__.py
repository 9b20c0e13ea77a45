"""Robot motions as data sets that other libraries load: LeRobot, WebDataset, NVIDIA's motion_v1.

    from retarget import packs

    clips = packs.clips_of("out/")                      # the passed motions of a batch
    packs.write_lerobot(clips, "out_lerobot/", robot="unitree_g1", fps=30)
    packs.write_webdataset(clips, "out_shards/", max_bytes=256 * 2**20)

A clip is a pair (name, motion): a unique name such as "a/walk", and a Motion or the path of a robot
motion file. Clips are a mapping, which is sorted by name, or an iterable of pairs in ascending
order of names; one motion at a time is in memory. The same clips give the same bytes (for Parquet,
with the same version of pyarrow). A data set is a folder that appears when it is complete.
LeRobot and motion_v1 need pyarrow.
"""

from retarget.packs._clips import clips_of
from retarget.packs._lerobot import write_lerobot
from retarget.packs._motion_v1 import write_motion_v1
from retarget.packs._webdataset import write_webdataset

__all__ = ["clips_of", "write_lerobot", "write_motion_v1", "write_webdataset"]
