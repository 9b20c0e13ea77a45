#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// Rotations of one joint over all frames.
[[nodiscard]] inline std::vector<Eigen::Quaterniond> rotation_track(const Clip& clip,
                                                                    std::size_t joint) {
  std::vector<Eigen::Quaterniond> track;
  track.reserve(clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    track.push_back(clip.rotations(frame)[joint]);
  }
  return track;
}

/// Translations of one slot (Skeleton::translation_slot) over all frames.
[[nodiscard]] inline std::vector<Eigen::Vector3d> translation_track(const Clip& clip,
                                                                    std::size_t slot) {
  std::vector<Eigen::Vector3d> track;
  track.reserve(clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    track.push_back(clip.translations(frame)[slot]);
  }
  return track;
}

}  // namespace retarget
