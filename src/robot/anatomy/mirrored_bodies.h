#pragma once

#include <vector>

#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// Returns the mirror image of every body: the body at the same place of the other limb, or of the
/// other side of the trunk; the body itself in the middle of the trunk; -1 if there is none. Names
/// do not matter.
[[nodiscard]] std::vector<int> mirrored_bodies(const Robot& robot, const RobotAnatomy& limbs);

}  // namespace retarget
