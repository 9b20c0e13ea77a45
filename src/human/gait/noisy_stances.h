#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "human/gait/source_feet.h"

namespace retarget {

/// Whether each end of the feet stands on the floor, by frame: left heel, left toe, right heel,
/// right toe.
using NoisyStances = std::array<std::vector<char>, 4>;

/// Index of one end of a foot in NoisyStances.
[[nodiscard]] constexpr std::size_t stance_index(int foot, int end) {
  return static_cast<std::size_t>(2 * foot + end);
}

/// Finds the stances of feet whose positions are noisy. Thresholds on single frames break such
/// stances where the noise peaks; here the most likely sequence of stances and swings of both feet
/// is found. In it a change must be supported by evidence over a tenth of a second, and an upright
/// body is rarely without support.
/// @param noise_speed  median speed of standing feet, m/s for a body with legs of kUsualSourceLeg
[[nodiscard]] NoisyStances find_noisy_stances(const SourceFeet& feet, double noise_speed);

}  // namespace retarget
