#pragma once

#include <Eigen/Geometry>
#include <cstddef>

#include "base/option_name.h"
#include "retarget/clip.h"

namespace retarget {

/// What to do where a motion's file is larger than its part of the memory.
inline constexpr const char* kLargeFileHint = OPTION("memory") " allows more; or split the motion";

/// Whether a file's frame rate may be one: what a recorder or a program writes, frames per second.
[[nodiscard]] constexpr bool is_plausible_rate(double fps) {
  return fps >= 1.0 && fps <= 10000.0;
}

/// Bytes that a frame of a clip of this skeleton takes in memory.
[[nodiscard]] inline std::size_t frame_bytes(const Skeleton& skeleton) {
  return static_cast<std::size_t>(skeleton.joint_count()) * sizeof(Eigen::Quaterniond) +
         static_cast<std::size_t>(skeleton.translated_count()) * sizeof(Eigen::Vector3d);
}

}  // namespace retarget
