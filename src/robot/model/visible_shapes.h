#pragma once

#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// Robot colour in pictures, 0xRRGGBB.
inline constexpr int kRobotColour = 0x7FA3C7;

/// Returns the shapes to draw a robot with: its collision shapes, or lines between bodies if it has
/// none.
[[nodiscard]] std::vector<CollisionShape> visible_shapes(const Robot& robot);

}  // namespace retarget
