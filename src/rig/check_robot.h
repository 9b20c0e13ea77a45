#pragma once

#include <string>
#include <vector>

#include "retarget/ik_config.h"
#include "retarget/robot.h"

namespace retarget {

/// Something that is wrong or odd about a robot.
struct RobotFinding {
  bool fault = false;  ///< It gives wrong motions or none; else worth knowing.
  std::string text;
};

/// Looks for everything that is wrong or odd about a robot, its profile and its mapping.
///
/// Faults: bodies and bones of the mapping that do not exist; offsets that leave a limb more than
/// 75 degrees off the T-pose; feet more than a quarter of a leg out of reach; no legs or arms to
/// map to. Notes: offsets more than 8 degrees off, targets slightly out of reach, joints that no
/// task moves, differences between left and right (weights, scales, offsets, ranges), limit sets
/// tighter than the model's ranges, joints without a speed limit, missing soles or T-pose.
/// @param tables  the robot's mapping; null: it has none.
[[nodiscard]] std::vector<RobotFinding> check_robot(const Robot& robot, const IkTables* tables);

}  // namespace retarget
