#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "human/motion_signature.h"

namespace retarget {

/// That a clip shows the movement of an earlier one.
struct DuplicateOf {
  std::size_t index = 0;  ///< Of the earlier one.
  bool mirrored = false;  ///< It is its mirror image.
  double distance = 0.0;  ///< signature_distance(), degrees.
};

/// Movements nearer than this to each other are one, degrees.
inline constexpr double kDuplicateDistance = 2.5;

/// Of each clip whether it repeats one before it that repeats none itself. Without comparing all pairs:
/// clips with means that could be of one movement are found in a k-d tree, and the nearest of them are
/// compared.
/// @param clips  in the order in which they are kept; null or empty ones repeat nothing.
[[nodiscard]] std::vector<std::optional<DuplicateOf>> find_duplicates(
    const std::vector<const MotionSignature*>& clips);

}  // namespace retarget
