#pragma once

#include <vector>

#include "retarget/human.h"

namespace retarget {

/// Returns the colour for the left, right or middle of a human in pictures, 0xRRGGBB.
[[nodiscard]] int side_colour(Side side);

/// Returns the colour of each joint: the side of its bone, or of the bone's joint it descends from.
[[nodiscard]] std::vector<int> joint_colours(const Skeleton& skeleton,
                                             const Calibration& calibration);

}  // namespace retarget
