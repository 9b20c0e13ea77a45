#pragma once

#include <memory>
#include <string>

#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

/// A robot with the joints of one of its profile's variants held (Robot::set_variant). Solvers keep
/// such joints exactly where they are held, wherever the model's qpos0 has them.
///
/// @param name  a variant, or the number of the robot's columns: the robot as it is.
/// Errors (kConfig): an unknown name suggests the nearest one and lists all.
[[nodiscard]] Result<std::shared_ptr<const Robot>> robot_variant(
    const std::shared_ptr<const Robot>& robot, const std::string& name);

/// Narrows the ranges of the joints that the robot's variant holds to their one position.
void hold_locked_joints(const Robot& robot, LimitSet& limits);

}  // namespace retarget
