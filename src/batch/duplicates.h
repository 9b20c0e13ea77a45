#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batch/manifest.h"
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
/// @param clips       in the order in which they are kept; null or empty ones repeat nothing.
/// @param keep_going  asked now and then; false: the rest is not looked at.
[[nodiscard]] std::vector<std::optional<DuplicateOf>> find_duplicates(
    const std::vector<const MotionSignature*>& clips, const std::function<bool()>& keep_going = {});

/// Which of the clips repeat others of them, by name. The first by name is kept.
/// @param clips  name and signature_bytes(); one name counts once, no bytes repeat nothing.
[[nodiscard]] std::map<std::string, RepeatedClip> repeated_clips(
    const std::vector<std::pair<std::string, std::string>>& clips,
    const std::function<bool()>& keep_going = {});

}  // namespace retarget
