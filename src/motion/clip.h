#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

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

/// Sets the tracks of a clip to those of another one, changed.
/// @param change  makes the track of all frames of `to` from one of `from`.
template <typename Change>
void change_tracks(const Clip& from, Clip& to, const Change& change) {
  for (int joint = 0; joint < from.skeleton().joint_count(); ++joint) {
    const auto track = change(rotation_track(from, joint));
    for (int i = 0; i < to.frame_count(); ++i) to.rotations(i)[joint] = track[i];
  }
  for (int slot = 0; slot < from.skeleton().translated_count(); ++slot) {
    const auto track = change(translation_track(from, slot));
    for (int i = 0; i < to.frame_count(); ++i) to.translations(i)[slot] = track[i];
  }
}

}  // namespace retarget
