#pragma once

#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// What pictures colour a robot with, 0xRRGGBB.
inline constexpr int kRobotColour = 0x7FA3C7;

/// What a robot is drawn with: its collision shapes; of one that has none, lines from body to body.
[[nodiscard]] std::vector<CollisionShape> visible_shapes(const Robot& robot);

}  // namespace retarget
