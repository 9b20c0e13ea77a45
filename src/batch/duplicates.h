#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "batch/motion_signature.h"
#include "retarget/repeated_clips.h"

namespace retarget {

/// Marks a clip as a duplicate of an earlier one.
struct DuplicateOf {
  std::size_t index = 0;  ///< Index of the earlier clip.
  bool mirrored = false;  ///< Whether it is the mirror image.
  double distance = 0.0;  ///< signature_distance(), degrees.
};

/// Maximum distance between duplicates, degrees.
inline constexpr double kDuplicateDistance = 2.5;

/// For each clip, finds an earlier clip that it duplicates and that is not a duplicate itself.
/// Instead of comparing all pairs, a k-d tree finds candidates with similar means, and the nearest
/// of them are compared.
/// @param clips       in order of preference; null or empty clips are never duplicates.
/// @param keep_going  polled regularly; when it returns false, the remaining clips are skipped.
/// @param limit       maximum distance of a duplicate, degrees.
[[nodiscard]] std::vector<std::optional<DuplicateOf>> find_duplicates(
    const std::vector<const MotionSignature*>& clips, const std::function<bool()>& keep_going = {},
    double limit = kDuplicateDistance);

}  // namespace retarget
