#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/robots.h"

namespace RETARGET_API retarget {

/// Loads a robot from an MJCF file and, unless the path is empty, a profile.
///
/// Drops everything that does not affect kinematics before compiling: mesh and height field geoms,
/// all assets, actuators, sensors, tendons, equalities, keyframes. Only the MJCF and its includes
/// are needed; inertias that come from meshes are lost. MuJoCo's errors are returned (kConfig, with
/// the line if MuJoCo reports it), its warnings become Robot::warnings; nothing is printed. The
/// model must have one free joint, its first; all others must be hinges or slides. A fixed-base
/// robot may have no free joint.
///
/// Without a profile the robot has its file's name, its model's joint order and ranges, and no
/// soles. A profile is JSON; every key except `name` is optional:
///
/// | key | value |
/// |---|---|
/// | `name`, `description`, `source`, `licence`, `revision`, `revision_date` | text |
/// | `base` | `floating` (default) or `fixed`: the robot has no soles, `soles` is ignored |
/// | `joint_order` | joint names: the output columns; joints not named are not written |
/// | `limit_sets` | name: `{"source": text, "ranges": {joint: [lower, upper]}}`, rad or m; joints
/// not named keep the model's range; the set `model` always exists |
/// | `default_limits` | name of a set (default: `model`) |
/// | `method_limits` | method: name of its default limit set |
/// | `speed_limits` | joint: rad/s or m/s, above 0 |
/// | `default_speed_limit` | for hinges not in `speed_limits`, rad/s (default: 20) |
/// | `speed_limits_source` | text |
/// | `torque_limits` | joint: largest torque, N m or N, above 0 (default: `actuatorfrcrange`) |
/// | `torque_limits_source` | text |
/// | `rotor_inertias` | joint: reflected rotor inertia, kg m^2 or kg (default: `armature`) |
/// | `rotor_inertias_source` | text |
/// | `t_pose` | joint: rad or m; joints not named are at 0 |
/// | `soles` | `left`, `right`: `{"body": name, "points": [[x, y, z], ...], "labels": [text,
/// ...]}`, metres in the body's frame; labels are optional |
/// | `soles_source` | text |
/// | `soles_estimated` | true: the soles are not measured (default: false) |
/// | `allowed_self_contact` | pairs of bodies that may touch |
/// | `variants` | name: `{"locked": {joint: position}, "description": text, "model": file,
/// "bodies": [name, ...], "anchors": {joint: [x, y, z]}}`; see variant.h |
/// | `joint_frames` | bodies that only hold a joint; see RobotProfile |
///
/// All faults of a profile are reported together (kConfig); unknown names come with the nearest
/// match.
/// @param base  kFixed overrides the profile.
[[nodiscard]] Result<std::shared_ptr<const Robot>> load_robot_files(
    const std::string& model_path, const std::string& profile_path = {},
    RobotBase base = RobotBase::kAuto);

/// Returns the names of locked joints in output order; these are the joints that another controller
/// owns if only arms follow.
[[nodiscard]] std::vector<std::string> locked_joints(const Robot& robot, const LimitSet& limits);

}  // namespace retarget
