"""Data sets of many clips: their inputs, their manifest, and clips solved apart from this process.

retarget.ray distributes this work over a cluster.
"""

from retarget.data_set.duplicates import Group, find_groups
from retarget.data_set.inputs import ClipSource, find_clips
from retarget.data_set.manifest import read_manifest
from retarget.data_set.page import write_page
from retarget.data_set.results import Result, read_results

__all__ = ["ClipSource", "Group", "Result", "find_clips", "find_groups", "read_manifest",
           "read_results", "write_page"]
