#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "edit/plant_feet.h"
#include "retarget/edit.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/two_bone_leg.h"

namespace retarget {

/// A stance of a foot: on its sole, its heel or its toes.
struct FootStand {
  int begin = 0, end = 0;           ///< Frames [begin, end).
  std::vector<FootStance> stances;  ///< One per frame.
};

/// Returns the stances of the left and right foot of a human. Extends the contacts of whole feet
/// (find_contacts) by frames with the heel up and the toes still down, or the toes up and the heel
/// already down, using the same thresholds. A foot whose toes are level with the ankle or above it
/// is lying, not standing.
/// @param same_stand  stances separated by less than this are merged, seconds.
[[nodiscard]] std::array<std::vector<FootStand>, 2> find_foot_stands(const HumanClip& human,
                                                                     double same_stand);

/// Returns the planted foot of a stance, at its current position.
/// @param frame   frame from which the toe position in the foot is taken.
/// @param ankles  poses of the ankle joint (ankle_poses) in every frame.
[[nodiscard]] PlantedFoot plant_of(const FootStand& stand, int foot, int frame,
                                   const std::vector<Pose>& ankles, const HumanClip& human);

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
