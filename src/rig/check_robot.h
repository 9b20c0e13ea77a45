#pragma once

#include <vector>

#include "retarget/ik_config.h"
#include "retarget/rig.h"
#include "retarget/robot.h"

namespace retarget {

/// check_robot of one mapping.
/// @param tables  the robot's mapping; null: it has none.
[[nodiscard]] std::vector<RobotFinding> check_robot(const Robot& robot, const IkTables* tables);

}  // namespace retarget
