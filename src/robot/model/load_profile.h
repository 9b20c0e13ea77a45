#pragma once

#include <string>

#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

/// Reads a profile (robot.json; load_robot.h describes its keys) for a model that is already
/// loaded. Reports all faults together.
/// @param bare  the robot of the model without a profile: body names, joint names, ranges.
[[nodiscard]] Result<RobotProfile> load_profile(const std::string& path, const Robot& bare);

}  // namespace retarget
