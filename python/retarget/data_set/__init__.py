"""Data sets of many clips: their inputs, their manifest, and clips solved apart from this process.

retarget.ray distributes this work over a cluster.
"""

from retarget.data_set.inputs import ClipSource, find_clips
from retarget.data_set.manifest import read_manifest
from retarget.data_set.page import write_page

__all__ = ["ClipSource", "find_clips", "read_manifest", "write_page"]
