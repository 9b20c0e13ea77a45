#pragma once

#include <memory>

#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

/// Like robot_variant, for a variant that is not in the profile.
[[nodiscard]] Result<std::shared_ptr<const Robot>> make_variant(
    const std::shared_ptr<const Robot>& robot, const RobotVariant& variant);

/// Narrows the ranges of the joints that the robot's variant locks to a single position.
void hold_locked_joints(const Robot& robot, LimitSet& limits);

}  // namespace retarget
