#pragma once

#include <vector>

#include "retarget/human.h"

namespace retarget {

/// What pictures colour the left, the right and the middle of a human with, 0xRRGGBB.
[[nodiscard]] int side_colour(Side side);

/// The same for each joint of a skeleton: those that stand for a bone of the human, and what hangs from them.
[[nodiscard]] std::vector<int> joint_colours(const Skeleton& skeleton,
                                             const Calibration& calibration);

}  // namespace retarget
