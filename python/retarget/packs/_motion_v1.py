"""NVIDIA's motion_v1: one Parquet file with one row per motion, in folders by sequence and robot.

The layout is that of robotic_grounding/motion_schema in the repository nvidia-isaac/video_to_data:
FOLDER/sequence_id=SEQUENCE/robot_name=ROBOT/data.parquet. Its reader takes the two values of the
folders, and only the first row of a file.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from retarget import _retarget
from retarget._errors import UsageError
from retarget.packs._clips import Clips, MotionReader, NamedMotion, StrPath
from retarget.packs._parquet import arrow, rows_of, write_table
from retarget.packs._parts import new_folder, parts

if TYPE_CHECKING:
    import pyarrow as pa

VERSION = "motion_v1"
FILE = "data.parquet"
_WRISTS = ("left_wrist_yaw_link", "right_wrist_yaw_link")


def write_motion_v1(clips: Clips, folder: StrPath, *,
                    robot: _retarget.Robot | StrPath | None = None, fps: float | None = None,
                    end_effectors: Sequence[str] | None = None, robot_name: str | None = None,
                    source_dataset: str = "", max_clips: int = 10_000,
                    replace: bool = False) -> list[Path]:
    """Writes NVIDIA's motion_v1 files of the kind `single_robot`, one per clip.

    Values are float32, in metres and radians; quaternions are w x y z (world_from_link), and the
    world frame has z up (`coord_frame` is "world_z_up"). The groups of hands, objects, contacts and
    source are empty: a motion has none. Earlier revisions of NVIDIA's reader require an object.

    Args:
        clips: motions by name. "/" in a name becomes "__" in `sequence_id`.
        folder: new folder; up to `max_clips` clips share a folder part-000000, part-000001, ...
        robot: robot of motion files, or an argument of Robot(); not needed for Motion objects.
        fps: frames per second that all motions must have, and rate of CSVs; None: the rate of the
            first motion. CSVs then have the rate of their sidecar, or that of the manifest for
            packs.clips_of(), or 30; `fps` must not contradict it.
        end_effectors: names of E bodies for `ee_pose_w` (F, E, 7); None: left_wrist_yaw_link and
            right_wrist_yaw_link, if the robot has them.
        robot_name: value of `robot_name`; None: the robot's name.
        source_dataset: value of `source_dataset`.
        max_clips: largest number of clips in a part.
        replace: replace an earlier pack or an empty folder.

    Returns:
        The folders of the parts, in order.

    Raises:
        UsageError: names out of order, two clips with one `sequence_id`, motions of different
            joints or rates, unknown or missing end effectors, an existing folder.
        InputError: a file is not a motion of the robot.
        ConfigError: pyarrow is not installed, or the robot is unknown.
        RunError: a file could not be written.
    """
    arrow()
    reader = MotionReader(robot, fps)
    done = []
    sequences: set[str] = set()
    with new_folder(folder, replace) as unfinished:
        for number, part in enumerate(parts(reader.motions(clips), lambda _: 0, 1, max_clips)):
            name = f"part-{number:06d}"
            for clip in part:
                robots_name = robot_name or reader.robot.name or Path(reader.robot.model).stem
                sequence = clip.name.replace("/", "__")
                if sequence in sequences:
                    raise UsageError(f"clips: two names become the sequence {sequence!r}, the "
                                     f"second one is {clip.name!r}")
                sequences.add(sequence)
                file = (unfinished / name / f"sequence_id={sequence}" /
                        f"robot_name={robots_name}" / FILE)
                links = _end_effectors(reader.robot, end_effectors)
                write_table(_table(clip, links, source_dataset), file)
            done.append(Path(folder) / name)
    return done


def _end_effectors(robot: _retarget.Robot, names: Sequence[str] | None) -> dict[str, int]:
    """Returns the indices of bodies by name."""
    known = {name: index for index, name in enumerate(robot.body_names)}
    if names is None and not all(name in known for name in _WRISTS):
        raise UsageError("end_effectors: needed, because the robot has no bodies called "
                         f"{' and '.join(_WRISTS)}")
    chosen = list(_WRISTS if names is None else names)
    for name in chosen:
        if name not in known:
            raise UsageError(f"end_effectors: the robot has no body {name!r}")
    if not chosen:
        raise UsageError("end_effectors: expected at least one body")
    return {name: known[name] for name in chosen}


def _end_effector_poses(motion: _retarget.Motion, links: dict[str, int]) -> np.ndarray:
    """Returns (F, E, 7) float32: positions and quaternions w x y z in the world frame."""
    bodies = list(links.values())
    poses = np.empty((len(motion), len(bodies), 7), dtype=np.float32)
    for frame, configuration in enumerate(motion.qpos):
        positions, rotations = motion.robot.forward_kinematics(configuration)
        poses[frame, :, :3] = positions[bodies]
        poses[frame, :, 3:] = rotations[bodies]
    return poses


def _table(clip: NamedMotion, links: dict[str, int], source_dataset: str) -> pa.Table:
    """Returns one row with all columns of the layout except the two in the path."""
    pa = arrow()
    motion = clip.motion
    joints = motion.joint_positions.astype(np.float32)
    offsets = np.arange(0, joints.size + 1, joints.shape[1], dtype=np.int32)
    series = {
        "robot_root_position": rows_of(motion.root_position.astype(np.float32)),
        "robot_root_wxyz": rows_of(motion.root_rotation_wxyz.astype(np.float32)),
        "robot_joint_positions": pa.ListArray.from_arrays(pa.array(offsets),
                                                          pa.array(joints.reshape(-1))),
        "ee_pose_w": rows_of(_end_effector_poses(motion, links)),
    }
    values = {"schema_version": VERSION, "motion_kind": "single_robot",
              "source_dataset": source_dataset, "raw_motion_file": Path(clip.file).name,
              "fps": motion.fps, "coord_frame": "world_z_up",
              "robot_joint_names": motion.joint_names, "ee_link_names": list(links)}
    columns = {}
    for name, kind in columns_of_layout():
        if name in series:
            whole = pa.array([0, len(series[name])], pa.int32())
            columns[name] = pa.ListArray.from_arrays(whole, series[name])
        else:
            columns[name] = pa.array([values.get(name, _empty(kind))], kind)
    return pa.table(columns)


def _empty(kind: pa.DataType) -> Any:
    """Returns the value of a group that a motion does not have."""
    types = arrow().types
    if types.is_string(kind):
        return ""
    if types.is_binary(kind):
        return b""
    return []


def columns_of_layout() -> Iterator[tuple[str, pa.DataType]]:
    """Yields names and types of the columns in a file, in order.

    F frames, J joints, E end effectors; "side" columns have one entry per hand.
    """
    pa = arrow()
    number, text = pa.float32(), pa.string()
    texts, numbers = pa.list_(text), pa.list_(number)
    vectors, quaternions = pa.list_(pa.list_(number, 3)), pa.list_(pa.list_(number, 4))
    many_vectors, many_poses = pa.list_(vectors), pa.list_(pa.list_(pa.list_(number, 7)))
    for name in ("schema_version", "motion_kind", "source_dataset", "raw_motion_file"):
        yield name, text
    yield from (("fps", number), ("coord_frame", text), ("robot_joint_names", texts),
                ("robot_root_position", vectors), ("robot_root_wxyz", quaternions),
                ("robot_joint_positions", pa.list_(numbers)), ("ee_link_names", texts),
                ("ee_pose_w", many_poses), ("hand_sides", texts),
                ("hand_frame_names", pa.list_(texts)), ("hand_frames_w", pa.list_(many_poses)),
                ("hand_finger_joint_names", pa.list_(texts)),
                ("hand_finger_joints", pa.list_(pa.list_(numbers))),
                ("object_name", text), ("safe_object_name", text))
    for name in ("object_body_names", "safe_object_body_names", "object_mesh_paths",
                 "object_urdf_paths"):
        yield name, texts
    yield from (("object_mesh_radius", numbers), ("object_articulation", numbers),
                ("object_root_axis_angle", vectors), ("object_root_position", vectors),
                ("object_body_position", many_vectors),
                ("object_body_wxyz", pa.list_(quaternions)),
                ("hand_contact_link_names", pa.list_(texts)))
    for name in ("hand_link_contact_positions", "hand_link_contact_normals",
                 "hand_object_contact_positions", "hand_object_contact_normals"):
        yield name, pa.list_(many_vectors)
    yield from (("hand_object_contact_part_ids", pa.list_(pa.list_(pa.list_(pa.int32())))),
                ("hand_contact_active", pa.list_(numbers)), ("source_kind", text),
                ("source_payload", pa.binary()), ("source_joint_names", texts),
                ("ik_error_per_frame", numbers), ("ik_num_iterations", pa.list_(pa.int32())),
                ("frame_task_errors", pa.list_(numbers)))
