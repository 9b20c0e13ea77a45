#pragma once

#include <memory>
#include <string>

#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

/// Returns a variant of a robot by its name in the profile.
///
/// A variant without its own model is the robot with some joints locked (Robot::set_variant):
/// solvers keep these exactly at their locked positions, regardless of the model's qpos0. A variant
/// with a model is another Robot loaded from it, with the profile restricted to the bodies and
/// joints that both have; Robot::whole() is the robot with all joints.
///
/// @param name  a variant, or the number of the robot's columns, which selects the robot unchanged.
/// Errors (kConfig): an unknown name suggests the nearest one and lists all; a model that cannot be
///   read, has another root, or whose joints are not the robot's without the locked ones.
[[nodiscard]] Result<std::shared_ptr<const Robot>> robot_variant(
    const std::shared_ptr<const Robot>& robot, const std::string& name);

/// The same for a variant that is not in the profile.
[[nodiscard]] Result<std::shared_ptr<const Robot>> make_variant(
    const std::shared_ptr<const Robot>& robot, const RobotVariant& variant);

/// Narrows the ranges of the joints that the robot's variant locks to a single position.
void hold_locked_joints(const Robot& robot, LimitSet& limits);

}  // namespace retarget
