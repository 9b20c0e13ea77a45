#pragma once

#include <vector>

#include "retarget/make_robot.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// Runs check_robot with one configuration.
/// @param config  the robot's configuration; null if it has none.
[[nodiscard]] std::vector<RobotFinding> check_robot(const Robot& robot,
                                                    const RetargetingConfig* config);

}  // namespace retarget
