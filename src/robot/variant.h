#pragma once

#include <memory>
#include <string>

#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

/// A variant of a robot, by the name that its profile has for it.
///
/// A variant without a model of its own is the robot with some joints held (Robot::set_variant):
/// solvers keep them exactly where they are held, wherever the model's qpos0 has them. One with a
/// model is another Robot, loaded from it, with what the profile says of the bodies and joints that
/// both have; Robot::whole() is the robot of all joints.
///
/// @param name  a variant, or the number of the robot's columns: the robot as it is.
/// Errors (kConfig): an unknown name suggests the nearest one and lists all; a model that cannot be
/// read, has another root, or other joints than the robot's without the locked ones.
[[nodiscard]] Result<std::shared_ptr<const Robot>> robot_variant(
    const std::shared_ptr<const Robot>& robot, const std::string& name);

/// The same for a variant that need not be one of the profile's.
[[nodiscard]] Result<std::shared_ptr<const Robot>> make_variant(
    const std::shared_ptr<const Robot>& robot, const RobotVariant& variant);

/// Narrows the ranges of the joints that the robot's variant holds to their one position.
void hold_locked_joints(const Robot& robot, LimitSet& limits);

}  // namespace retarget
