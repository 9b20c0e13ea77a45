#pragma once

#include <array>
#include <vector>

#include "human/skeleton/limb_segments.h"
#include "retarget/solve.h"

namespace retarget {

/// Angles between the limbs of a robot and its human in one frame, degrees, in the order of
/// kLimbSegments; 0 for limbs that either lacks.
using LimbErrors = std::array<double, kLimbSegments.size()>;

/// The angles in every frame of a motion, between joint centres or, if the robot's tree does not
/// define them, body origins.
[[nodiscard]] std::vector<LimbErrors> limb_errors(const Motion& motion);

/// Mean over the limbs.
[[nodiscard]] double mean_error(const LimbErrors& errors);

/// The largest increase of an angle.
[[nodiscard]] double largest_increase(const LimbErrors& from, const LimbErrors& to);

}  // namespace retarget
