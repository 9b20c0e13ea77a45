#pragma once

#include <span>
#include <string>
#include <vector>

#include "pipeline/limit_diagnosis.h"

namespace retarget {

/// Joints that are at a limit in less than this share of the frames are not named.
inline constexpr double kNamedAtLimit = 0.05;

/// A line for each of the worst joints at a limit: how often, what pushes it, what other limit set
/// would let it move on.
[[nodiscard]] std::vector<std::string> limit_lines(std::span<const JointAtLimit> joints,
                                                   const Robot& robot, const LimitSet& limits);

}  // namespace retarget
