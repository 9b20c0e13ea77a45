#pragma once

#include <vector>

#include "retarget/clip.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/robot.h"

// How pictures, pages and GLB files show a robot and its human.
namespace RETARGET_API retarget {

/// Robot colour in pictures, 0xRRGGBB.
inline constexpr int kRobotColour = 0x7FA3C7;

/// Returns the shapes to draw a robot with: its collision shapes, or lines between bodies if it has
/// none.
[[nodiscard]] std::vector<CollisionShape> visible_shapes(const Robot& robot);

/// Returns the colour for the left, right or middle of a human in pictures, 0xRRGGBB.
[[nodiscard]] int side_colour(Side side);

/// Returns the colour of each joint: the side of its bone, or of the bone's joint it descends from.
[[nodiscard]] std::vector<int> joint_colours(const Skeleton& skeleton,
                                             const Calibration& calibration);

}  // namespace retarget
