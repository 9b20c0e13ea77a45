"""The published class on the engine of retarget."""

from __future__ import annotations

import json
import math
import os
import pathlib
from collections.abc import Mapping
from numbers import Real
from typing import Any

import numpy as np

from retarget import _retarget
from retarget._errors import ConfigError, UsageError
from retarget.gmr._errors import UnknownNameError, unknown_name
from retarget.gmr.params import IK_CONFIG_DICT, ROBOT_XML_DICT


class _NotOffered:
    """An attribute of the published class that is not supported, and its replacement."""

    def __init__(self, instead: str) -> None:
        self._instead = instead

    def __get__(self, instance: object, owner: type) -> Any:
        if instance is None:
            return self
        raise AttributeError(self._instead)


_ROOT_JOINT = "floating_base"
_ROOT_SIZE = 7  # values of the root in qpos


class GeneralMotionRetargeting:
    """Retargets a human to a robot frame by frame, starting from the previous frame.

    Constructor, methods and results match the published class; the solver is retarget's own.
    Human frames are {body: (position (3,), quaternion (4,) w x y z)}, world, metres, Z up: tuples,
    lists, arrays of any kind of number. They are not changed.

    Attributes:
        xml_file: the robot's MJCF.
        qpos: (7 + N,) the robot's configuration: root x y z (metres), root quaternion w x y z,
            joints (radians); start of the next frame. Can be set.
        human_root_name, robot_root_name: root bodies.
        human_scale_table: {body: scale}, including the height; changes apply to the next frame.
        ik_match_table1, ik_match_table2: {robot body: [human body, position weight, rotation
            weight, position offset, rotation offset]}, as read.
        ground: (3,) ground height of the tables, subtracted from position offsets.
        ground_offset: metres by which targets are lowered, see set_ground_offset.
        max_iter: further steps of a pass after the first one, at most 30. Can be set.
        damping: damping of every degree of freedom in a step. Can be set.
        solver: the given name; the actual solver is retarget's own, which is exact.
        robot_dof_names, robot_body_names, robot_motor_names: {name: index}; motors are the joints.
        pos_offsets1, rot_offsets1: {body: (3,) metres}, {body: (4,) w x y z} of table 1.
        scaled_human_data: the targets of the last frame, {body: [position, quaternion]}.
        model: mujoco.MjModel of xml_file, if the package mujoco is installed.
    """

    def __init__(self, src_human: str, tgt_robot: str, actual_human_height: float | None = None,
                 solver: str = "daqp", damping: float = 5e-1, verbose: bool = True,
                 use_velocity_limit: bool = True, *,
                 ik_config: str | os.PathLike[str] | None = None) -> None:
        """Loads a robot and the tables of a human for it.

        Args:
            src_human: a key of IK_CONFIG_DICT: "bvh_lafan1", "smplx", ...
            tgt_robot: a key of ROBOT_XML_DICT: "unitree_g1", ...
            actual_human_height: metres; scales are multiplied by its ratio to the height that the
                tables assume. None: scales remain unchanged.
            solver: any name is accepted; the solver is retarget's own.
            damping: damping of every degree of freedom in a step.
            verbose: prints the files that are used.
            use_velocity_limit: accepted without effect, as in the published class.
            ik_config: a table file to use instead of that in IK_CONFIG_DICT.
        """
        if tgt_robot not in ROBOT_XML_DICT:
            raise unknown_name("robot", tgt_robot, ROBOT_XML_DICT,
                               "add the path of an MJCF to ROBOT_XML_DICT for another robot")
        self.xml_file = str(ROBOT_XML_DICT[tgt_robot])
        self._config_file = _config_file(src_human, tgt_robot, ik_config)
        self._config = _read_config(self._config_file)
        if verbose:
            print("Use robot model: ", self.xml_file)
            print("Use IK config: ", self._config_file)
        self.src_human = src_human
        self.tgt_robot = tgt_robot
        self.solver = solver
        self.use_velocity_limit = use_velocity_limit
        self.human_scale_table = _scaled(self._config, actual_human_height)
        self.ground_offset = 0.0
        self._damping = float(damping)
        self._max_iter = 10
        self._targets: dict[str, list[np.ndarray]] | None = None
        self._has_targets = False
        self._load()
        self._set_up_names()
        self._core.set_qpos(self._initial_qpos())

    # ------------------------------------------------------------------ frames

    def retarget(self, human_data: Mapping[str, Any], offset_to_ground: bool = False) -> np.ndarray:
        """Retargets a frame.

        Args:
            human_data: {body: (position (3,), quaternion (4,) w x y z)}, world, metres, Z up.
            offset_to_ground: lifts or lowers the frame until its lowest foot is 0.1 m over the
                ground.

        Returns:
            (7 + N,) float64, a new array: root x y z (metres), root quaternion w x y z, joints
            in the model's order (radians).
        """
        self.update_targets(human_data, offset_to_ground)
        return self._core.solve()

    def update_targets(self, human_data: Mapping[str, Any], offset_to_ground: bool = False) -> None:
        """Scales and offsets a frame of the human to targets, without solving; see retarget."""
        if self.human_scale_table != self._scales_in_use:
            self._load(self._core)
        self._core.update_targets(human_data, float(self.ground_offset), bool(offset_to_ground))
        self._targets = None
        self._has_targets = True

    def error1(self) -> float:
        """Norm of the errors of table 1's tasks, metres and radians, without weights."""
        return self._core.error(1)

    def error2(self) -> float:
        """The same for table 2."""
        return self._core.error(2)

    @property
    def scaled_human_data(self) -> dict[str, list[np.ndarray]]:
        """The targets of the last frame: {body: [position (3,), quaternion (4,) w x y z]}."""
        if not self._has_targets:
            raise AttributeError("scaled_human_data exists only after retarget() or update_targets()")
        targets = self._targets
        if targets is None:
            names, positions, rotations = self._core.targets()
            targets = {name: [position.copy(), rotation.copy()]
                       for name, position, rotation in zip(names, positions, rotations)}
            self._targets = targets
        return targets

    def set_ground_offset(self, ground_offset: float) -> None:
        """Lowers the targets of all following frames by this many metres."""
        if not isinstance(ground_offset, Real) or not math.isfinite(ground_offset):
            raise UsageError(f"ground_offset: expected a finite number, found {ground_offset!r}")
        self.ground_offset = ground_offset

    # ------------------------------------------------- the steps of update_targets

    def to_numpy(self, human_data: Mapping[str, Any]) -> dict[str, list[np.ndarray]]:
        """Converts lists and tuples of a frame to arrays."""
        return {name: [np.asarray(position), np.asarray(rotation)]
                for name, (position, rotation) in human_data.items()}

    def scale_human_data(self, human_data: Mapping[str, Any], human_root_name: str,
                         human_scale_table: Mapping[str, float],
                         ) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Scales a frame: the root about the origin, other bodies of the table about the root."""
        if human_root_name not in human_data or human_root_name not in human_scale_table:
            raise unknown_name("root", human_root_name, set(human_data) & set(human_scale_table))
        names = [human_root_name] + [name for name in human_data
                                     if name in human_scale_table and name != human_root_name]
        positions = _retarget.scale_about([human_data[name][0] for name in names],
                                          [human_scale_table[name] for name in names], 0)
        return {name: (position.copy(), np.asarray(human_data[name][1]))
                for name, position in zip(names, positions)}

    def offset_human_data(self, human_data: Mapping[str, Any], pos_offsets: Mapping[str, Any],
                          rot_offsets: Mapping[str, Any]) -> dict[str, list[np.ndarray]]:
        """A frame with offsets: rotations first, then positions in the rotated axes.

        Rotation offsets are quaternions w x y z or SciPy's Rotation.
        """
        offset: dict[str, list[np.ndarray]] = {}
        for name, (position, rotation) in human_data.items():
            turn = rot_offsets[name]
            if hasattr(turn, "as_quat"):
                turn = np.roll(turn.as_quat(), 1)
            moved = _retarget.offset_pose(position, rotation, pos_offsets[name], turn)
            offset[name] = [array.copy() for array in moved]
        return offset

    def offset_human_data_to_ground(self, human_data: Mapping[str, Any],
                                    ) -> dict[str, list[np.ndarray]]:
        """Moves a frame vertically so that the lowest body with foot in its name is at 0.1 m."""
        feet = [np.asarray(position)[2] for name, (position, _) in human_data.items()
                if "foot" in name or "Foot" in name]
        if not feet:
            raise UsageError("cannot move the targets to the ground: no body has foot in its name")
        return {name: [np.asarray(position) - [0.0, 0.0, min(feet)] + [0.0, 0.0, 0.1],
                       np.asarray(rotation)] for name, (position, rotation) in human_data.items()}

    def apply_ground_offset(self, human_data: Mapping[str, Any]) -> dict[str, list[np.ndarray]]:
        """Lowers a frame by ground_offset."""
        return {name: [np.asarray(position) - [0.0, 0.0, self.ground_offset], np.asarray(rotation)]
                for name, (position, rotation) in human_data.items()}

    # ------------------------------------------------------------------- state

    @property
    def qpos(self) -> np.ndarray:
        """(7 + N,) the robot's configuration, a copy; start of the next frame."""
        return self._core.qpos

    @qpos.setter
    def qpos(self, value: Any) -> None:
        self._core.set_qpos(value)

    def setup_retarget_configuration(self) -> None:
        """Resets the solver: the next frame starts like the first one."""
        self._core.set_qpos(self._initial_qpos())

    @property
    def damping(self) -> float:
        """Damping of every degree of freedom in a step."""
        return self._damping

    @damping.setter
    def damping(self, value: float) -> None:
        before, self._damping = self._damping, float(value)
        self._reload_or_undo("_damping", before)

    @property
    def max_iter(self) -> int:
        """Further steps of a pass after the first one."""
        return self._max_iter

    @max_iter.setter
    def max_iter(self, value: int) -> None:
        before, self._max_iter = self._max_iter, int(value)
        self._reload_or_undo("_max_iter", before)

    @property
    def model(self) -> Any:
        """mujoco.MjModel of xml_file; needs the package mujoco."""
        if "_model" not in self.__dict__:
            try:
                import mujoco  # type: ignore
            except ImportError:
                raise AttributeError(
                    "model needs the package mujoco: pip install mujoco; retarget itself does not "
                    "need it, retarget.Robot provides names and kinematics") from None
            self._model = mujoco.MjModel.from_xml_path(self.xml_file)
        return self._model

    configuration = _NotOffered(
        "mink configurations are not supported: read and set the attribute qpos")
    ik_limits = _NotOffered(
        "mink limits are not supported: joints stay in the ranges of the robot's model")
    tasks1 = human_body_to_task1 = task_errors1 = _NotOffered(
        "mink tasks are not supported: error1() gives their error, ik_match_table1 defines them")
    tasks2 = human_body_to_task2 = task_errors2 = _NotOffered(
        "mink tasks are not supported: error2() gives their error, ik_match_table2 defines them")

    # ------------------------------------------------------------------- inner

    def _load(self, before: _retarget.FrameRetargeter | None = None) -> None:
        """Recreates the solver with the current scales and options, continuing from another one."""
        scales = dict(self.human_scale_table)
        try:
            text = json.dumps({**self._config, "human_scale_table": scales})
        except TypeError:
            raise UsageError(f"human_scale_table: expected numbers, found {scales}") from None
        profile = pathlib.Path(self.xml_file).parent / "robot.json"
        core = _retarget.FrameRetargeter(
            model=self.xml_file, profile=str(profile) if profile.is_file() else "", config=text,
            config_file=self._config_file, damping=self._damping, max_extra_steps=self._max_iter,
            engine="fast")
        if before is not None:
            core.go_on_from(before)
        self._core = core
        self._scales_in_use = scales
        self._targets = None

    def _reload_or_undo(self, name: str, before: Any) -> None:
        try:
            self._load(self._core)
        except Exception:
            setattr(self, name, before)
            raise

    def _set_up_names(self) -> None:
        config = self._config
        self.ik_match_table1 = config["ik_match_table1"]
        self.ik_match_table2 = config["ik_match_table2"]
        self.use_ik_match_table1 = config.get("use_ik_match_table1", True)
        self.use_ik_match_table2 = config.get("use_ik_match_table2", True)
        self.human_root_name = config["human_root_name"]
        self.robot_root_name = config["robot_root_name"]
        self.ground = config["ground_height"] * np.array([0, 0, 1])
        self.robot_init_qpos_table = config.get("robot_initial_qpos", {})
        joints = list(self._core.joint_names)
        self.robot_dof_names = {_ROOT_JOINT: 5} | {name: 6 + i for i, name in enumerate(joints)}
        self.robot_motor_names = {name: i for i, name in enumerate(joints)}
        self.robot_body_names = {name: i for i, name in enumerate(self._core.body_names)}
        self.pos_offsets1, self.rot_offsets1 = _offsets(self.ik_match_table1, self.ground)
        self.pos_offsets2, self.rot_offsets2 = _offsets(self.ik_match_table2, self.ground)

    def _initial_qpos(self) -> np.ndarray:
        """Start of a motion: the zero configuration with the joint values of the tables."""
        if not hasattr(self, "_zero_qpos"):
            self._zero_qpos = self._core.qpos
        qpos = self._zero_qpos.copy()
        for name, value in self.robot_init_qpos_table.items():
            try:
                if name in self.robot_motor_names:
                    qpos[_ROOT_SIZE + self.robot_motor_names[name]] = float(value)
                elif np.size(value) == _ROOT_SIZE:
                    qpos[:_ROOT_SIZE] = np.ravel(value)
                else:
                    raise ConfigError(f'{self._config_file}: "robot_initial_qpos" names {name!r}, '
                                      "which is not a joint of the robot")
            except (TypeError, ValueError) as error:
                if isinstance(error, ConfigError):
                    raise
                raise ConfigError(f'{self._config_file}: "robot_initial_qpos" of {name!r} is not a '
                                  f"position of a joint: {value!r}") from None
        return qpos


def _config_file(src_human: str, tgt_robot: str, given: str | os.PathLike[str] | None) -> str:
    if given is not None:
        return os.fsdecode(given)
    if src_human not in IK_CONFIG_DICT:
        raise unknown_name("human", src_human, IK_CONFIG_DICT)
    configs = IK_CONFIG_DICT[src_human]
    if tgt_robot not in configs:
        others = f", only for {', '.join(configs)}" if configs else ""
        raise UnknownNameError(
            f"no tables of {src_human!r} for {tgt_robot!r}{others}; ik_config accepts a file; "
            "tables of the published package are used if it is installed, or if RETARGET_GMR_ROOT "
            "names a checkout")
    return str(configs[tgt_robot])


def _read_config(path: str) -> dict[str, Any]:
    try:
        with open(path, encoding="utf-8") as file:
            config: dict[str, Any] = json.load(file)
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: not JSON: {error}", file=path) from None
    keys: dict[str, Any] = {"ik_match_table1": dict, "ik_match_table2": dict, "human_scale_table": dict,
            "human_root_name": str, "robot_root_name": str, "ground_height": (int, float),
            "human_height_assumption": (int, float)}
    for key, kind in keys.items():
        if not isinstance(config, dict) or not isinstance(config.get(key), kind):
            raise ConfigError(f'{path}: not a retargeting configuration: "{key}" is missing or '
                              "has the wrong type", file=path)
    return config


def _scaled(config: dict[str, Any], height: float | None) -> dict[str, float]:
    ratio = 1.0
    if height is not None:
        try:
            ratio = float(height) / config["human_height_assumption"]
        except (TypeError, ValueError, ZeroDivisionError):
            ratio = 0.0
        if not 0.0 < ratio < float("inf"):
            raise UsageError(f"actual_human_height: expected metres, found {height!r}")
    try:
        return {name: scale * ratio for name, scale in config["human_scale_table"].items()}
    except TypeError:
        raise ConfigError('"human_scale_table" must be an object of numbers') from None


def _offsets(table: dict[str, Any], ground: np.ndarray) -> tuple[
        dict[str, np.ndarray], dict[str, np.ndarray]]:
    positions: dict[str, np.ndarray] = {}
    rotations: dict[str, np.ndarray] = {}
    for body, position_weight, rotation_weight, position, rotation in table.values():
        if position_weight or rotation_weight:
            positions[body] = np.asarray(position, dtype=float) - ground
            unit = np.asarray(rotation, dtype=float)
            rotations[body] = unit / np.linalg.norm(unit)
    return positions, rotations
