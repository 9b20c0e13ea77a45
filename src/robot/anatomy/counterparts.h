#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/robot.h"
#include "robot/anatomy/branches.h"

namespace retarget {

/// Explains which limb or joint lacks a counterpart on the other side; nothing if all have one. Two
/// branches of one body that mirror each other up to a joint are the same limb. A branch on its own
/// is a limb if it is beside the trunk, as seen by the pairs that were found.
/// @param pairs  of branch_pairs.
[[nodiscard]] std::optional<std::string> missing_counterpart(const Robot& robot,
                                                             const TreeState& posed,
                                                             const std::vector<BranchPair>& pairs);

}  // namespace retarget
