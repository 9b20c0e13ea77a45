#pragma once

#include <utility>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// Returns the pairs of moving bodies at most two joints apart in the tree. They overlap by design,
/// so their contact is allowed. The body nearer to the root comes first.
[[nodiscard]] std::vector<std::pair<int, int>> neighbours(const Robot& robot);

}  // namespace retarget
