#pragma once

#include <optional>
#include <vector>

#include "judge/quality/limb_directions.h"

namespace retarget {

/// Delay of the robot's limbs relative to the human's, seconds: the shift of the human's limbs,
/// within half a second either way, that maximises the correlation of the rates at which both turn.
/// Nothing if limbs hardly move, for clips of less than a second, and if the robot's motion does
/// not resemble the human's.
[[nodiscard]] std::optional<double> limb_lag(const std::vector<LimbDirections>& limbs, double fps);

}  // namespace retarget
