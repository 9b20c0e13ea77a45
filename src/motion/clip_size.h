#pragma once

#include <Eigen/Geometry>
#include <cstddef>

#include "base/option_name.h"
#include "retarget/clip.h"

namespace retarget {

/// Hint for a motion file that exceeds its share of the memory.
inline constexpr const char* kLargeFileHint = OPTION("memory") " allows more; or split the motion";

/// Whether a frame rate is plausible for a recording or a program, frames per second.
[[nodiscard]] constexpr bool is_plausible_rate(double fps) {
  return fps >= 1.0 && fps <= 10000.0;
}

/// Memory that a frame of a clip with this skeleton takes, bytes.
[[nodiscard]] inline std::size_t frame_bytes(const Skeleton& skeleton) {
  return static_cast<std::size_t>(skeleton.joint_count()) * sizeof(Eigen::Quaterniond) +
         static_cast<std::size_t>(skeleton.translated_count()) * sizeof(Eigen::Vector3d);
}

}  // namespace retarget
