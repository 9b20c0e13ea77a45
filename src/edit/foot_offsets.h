#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "edit/plant_feet.h"
#include "edit/two_bone_leg.h"
#include "retarget/edit.h"
#include "retarget/pose.h"

namespace retarget {

/// What a foot's pose lacks, frame by frame.
struct FootOffsets {
  std::vector<Eigen::Vector3d> shifts, turns;  ///< World, metres and rotation vectors.
  std::vector<bool> planted, heel_up;

  explicit FootOffsets(std::size_t frames)
      : shifts(frames, Eigen::Vector3d::Zero()),
        turns(shifts),
        planted(frames, false),
        heel_up(planted) {}

  /// Whether there is more than rounding.
  [[nodiscard]] bool any(std::size_t frame) const;
  void set(std::size_t frame, const Pose& wanted, const LegTrack& leg);
  /// The ankle's pose as it shall be.
  [[nodiscard]] Pose moved(std::size_t frame, const LegTrack& leg) const;
  /// How far the leg is stretched for that with the hips lowered by `drop`.
  [[nodiscard]] LegReach reach(std::size_t frame, const LegTrack& leg, double drop,
                               const PlantOptions& options) const;
};

/// Where a foot has to stand, and what its leg lacks there; the frames between are still to be
/// filled.
[[nodiscard]] FootOffsets planted_offsets(std::span<const PlantedFoot> plants, int foot,
                                          const LegTrack& leg);

/// Where its toes are down and the leg would be stretched too far, turns it about them.
/// @param drops  how far the hips are lowered, per frame.
/// @param ramp   after so many frames with the toes down it may turn as far as it can.
void rise_on_toes(FootOffsets& offsets, std::span<const PlantedFoot> plants, int foot,
                  const LegTrack& leg, const std::vector<double>& drops,
                  const PlantOptions& options, int ramp);

/// Before, between and after its places the offset fades as plant_feet says.
/// @param release  how long it fades, frames.
void fade_offsets(FootOffsets& offsets, int release);

}  // namespace retarget
