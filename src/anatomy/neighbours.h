#pragma once

#include <utility>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// Pairs of moving bodies that lie at most two joints apart in the tree: they overlap by build, so
/// that their contact is no fault. The one nearer to the root comes first.
[[nodiscard]] std::vector<std::pair<int, int>> neighbours(const Robot& robot);

}  // namespace retarget
