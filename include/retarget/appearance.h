#pragma once

#include <vector>

#include "retarget/clip.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/robot.h"

// Appearance of a robot and its human in renderings, pages and GLB files.
namespace RETARGET_API retarget {

/// Robot colour in renderings, 0xRRGGBB.
inline constexpr int kRobotColour = 0x7FA3C7;

/// Returns the shapes that represent a robot: its collision shapes, or lines between bodies if it
/// has none.
[[nodiscard]] std::vector<CollisionShape> visible_shapes(const Robot& robot);

/// Returns the colour for the left side, right side or middle of a human in renderings, 0xRRGGBB.
[[nodiscard]] int side_colour(Side side);

/// Returns the colour of each joint: the side of its bone, or of the bone's joint it descends from.
[[nodiscard]] std::vector<int> joint_colours(const Skeleton& skeleton,
                                             const Calibration& calibration);

}  // namespace retarget
