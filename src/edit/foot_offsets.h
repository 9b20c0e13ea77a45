#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "edit/plant_feet.h"
#include "motion/two_bone_leg.h"
#include "retarget/edit.h"
#include "retarget/pose.h"

namespace retarget {

/// Correction of a foot's pose per frame.
struct FootOffsets {
  std::vector<Eigen::Vector3d> shifts, turns;  ///< World frame; metres and rotation vectors.
  std::vector<bool> planted, heel_up;

  explicit FootOffsets(std::size_t frames)
      : shifts(frames, Eigen::Vector3d::Zero()),
        turns(shifts),
        planted(frames, false),
        heel_up(planted) {}

  /// Returns true if the correction exceeds rounding errors.
  [[nodiscard]] bool any(std::size_t frame) const;
  void set(std::size_t frame, const Pose& wanted, const LegTrack& leg);
  /// Returns the corrected pose of the ankle.
  [[nodiscard]] Pose moved(std::size_t frame, const LegTrack& leg) const;
  /// Returns how far the leg stretches for that with the hips lowered by `drop`.
  [[nodiscard]] LegReach reach(std::size_t frame, const LegTrack& leg, double drop,
                               const PlantOptions& options) const;
};

/// Returns the corrections of a foot in the frames in which it is planted. The frames between are
/// not filled yet.
[[nodiscard]] FootOffsets planted_offsets(std::span<const PlantedFoot> plants, int foot,
                                          const LegTrack& leg);

/// Rotates the foot about its toes where these are down and the leg would be stretched too far.
/// @param drops  how far the hips are lowered, per frame.
/// @param ramp   number of frames with the toes down after which the full rotation is allowed.
void rise_on_toes(FootOffsets& offsets, std::span<const PlantedFoot> plants, int foot,
                  const LegTrack& leg, const std::vector<double>& drops,
                  const PlantOptions& options, int ramp);

/// Fades the corrections before, between and after the planted runs as described at plant_feet.
/// @param release  length of the fade, frames.
void fade_offsets(FootOffsets& offsets, int release);

}  // namespace retarget
