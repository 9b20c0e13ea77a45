#pragma once

#include <memory>
#include <string>

#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "robot/find_robot.h"

namespace retarget {

/// Loads a robot from an MJCF file and, unless the path is empty, a profile.
///
/// What plays no part in kinematics is dropped before compiling: mesh and height field geoms, all
/// assets, actuators, sensors, tendons, equalities, keyframes. So no file is needed beside the
/// MJCF and what it includes; inertias that come from meshes are lost. MuJoCo's errors become ours
/// (kConfig, with the line where MuJoCo tells it), its warnings Robot::warnings; nothing is
/// printed. The model must have one free joint, its first, and else hinges and slides; that of a robot
/// whose base stands fast may have none.
///
/// Without a profile the robot has its file's name, its model's joint order and ranges, and no
/// soles. A profile is JSON; every key but `name` may be left out:
///
/// | key | value |
/// |---|---|
/// | `name`, `description`, `source`, `licence` | texts |
/// | `base` | `floating` (default) or `fixed`: the robot has no soles, whatever `soles` says |
/// | `joint_order` | joint names: the output columns; joints not named are not written |
/// | `limit_sets` | name: `{"source": text, "ranges": {joint: [lower, upper]}}`, rad or m; joints
/// not named keep the model's range; the set `model` is always there |
/// | `default_limits` | name of a set (default: `model`) |
/// | `method_limits` | method: name of the set that it takes by default |
/// | `speed_limits` | joint: rad/s or m/s, above 0 |
/// | `default_speed_limit` | of the hinges that `speed_limits` does not name, rad/s (default: 20) |
/// | `speed_limits_source` | text |
/// | `torque_limits` | joint: largest torque, N m or N, above 0 (default: `actuatorfrcrange`) |
/// | `torque_limits_source` | text |
/// | `rotor_inertias` | joint: what its rotor adds to its inertia, kg m^2 or kg (default: `armature`) |
/// | `rotor_inertias_source` | text |
/// | `t_pose` | joint: rad or m; joints not named are at 0 |
/// | `soles` | `left`, `right`: `{"body": name, "points": [[x, y, z], ...], "labels": [text,
/// ...]}`, metres in the body's frame; labels may be left out |
/// | `soles_source` | text |
/// | `soles_estimated` | true: nothing measured tells the soles (default: false) |
/// | `allowed_self_contact` | pairs of bodies whose contact is no fault |
/// | `variants` | name: `{"locked": {joint: position}, "description": text, "model": file, "bodies":
/// [name, ...]}`; see variant.h |
///
/// Faults of a profile are named all at once (kConfig), with the nearest name where one is unknown.
/// @param base  kFixed: whatever the profile says.
[[nodiscard]] Result<std::shared_ptr<const Robot>> load_robot_files(
    const std::string& model_path, const std::string& profile_path = {},
    RobotBase base = RobotBase::kAuto);

}  // namespace retarget
