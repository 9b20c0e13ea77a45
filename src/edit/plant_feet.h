#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/pose.h"
#include "retarget/two_bone_leg.h"

namespace retarget {

/// Positions of a leg per frame before its foot is moved, in the canonical human's world, metres.
struct LegTrack {
  std::vector<Pose> ankles;           ///< Poses of the ankle joint.
  std::vector<Eigen::Vector3d> hips;  ///< Positions of the thigh's origin.
  std::vector<double> lengths;        ///< Total length of thigh and shin.
};

/// Returns the world poses of a leg's ankle (the file's joint and its axes) in every frame, metres,
/// z up.
[[nodiscard]] std::vector<Pose> ankle_poses(const Clip& clip, const Calibration& calibration,
                                            const LegJoints& leg);

/// The part of a foot that touches the floor.
enum class FootStance : std::uint8_t { kOnHeel, kOnSole, kOnToes };

/// Target poses of a foot over a range of frames.
struct PlantedFoot {
  int foot = 0;                       ///< 0: left, 1: right.
  int begin = 0;                      ///< First frame.
  std::vector<Pose> world_from_foot;  ///< One per frame: poses of the ankle joint, as in
                                      ///< ankle_poses.
  /// One per frame; empty: always on its sole. A foot with its toes down may rotate about them if
  /// its leg would be too short.
  std::vector<FootStance> stances = {};
  /// Position of the toes in the ankle joint's frame, metres; nothing if unknown.
  std::optional<Eigen::Vector3d> toes_in_foot = std::nullopt;

  [[nodiscard]] int end() const { return begin + static_cast<int>(world_from_foot.size()); }
};

/// Moves feet to their planted poses, in place.
///
/// The correction of a foot is known in the frames in which it is planted. Before and after, it
/// fades (a cubic with continuous velocity); between two plants that are close in time it
/// interpolates. Each leg follows its foot by two-bone inverse kinematics: the knee bends in its
/// own plane, the hip rotates minimally, the foot keeps its target pose. Where a leg would be too
/// short, a foot on its toes rotates about them and the hips are lowered smoothly; a leg near full
/// stretch follows only in part. Frames without a correction stay bit-identical.
///
/// @param plants  sorted by time for each foot, without overlap; feet without a leg are ignored.
/// @return kInput errors as for BodyMover::of.
[[nodiscard]] Result<PlantSummary> plant_feet(Clip& clip, const Calibration& calibration,
                                              std::span<const PlantedFoot> plants,
                                              const PlantOptions& options = {});

/// Returns the human-readable summary of the corrections.
[[nodiscard]] std::string planted_text(const PlantSummary& feet);

/// Merges contacts separated by less than `seconds`: no step is that short, so the foot stays down.
[[nodiscard]] std::vector<ContactPhase> without_short_breaks(
    const std::vector<ContactPhase>& phases, double seconds, const FrameRate& rate);

/// A stance of a foot: on its sole, its heel or its toes.
struct FootStand {
  int begin = 0, end = 0;           ///< Frames [begin, end).
  std::vector<FootStance> stances;  ///< One per frame.
};

/// Returns the stances of the left and right foot of a human. Extends the contacts of whole feet
/// (find_contacts) by frames with the heel up and the toes still down, or the toes up and the heel
/// already down, using the same thresholds. A foot whose toes are level with the ankle or above it
/// is lying, not standing. Short breaks of a stance are ignored.
[[nodiscard]] std::array<std::vector<FootStand>, 2> find_foot_stands(const HumanClip& human);

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
  [[nodiscard]] LegReach reach(std::size_t frame, const LegTrack& leg, double drop) const;
};

/// Returns the corrections of a foot in the frames in which it is planted. The frames between are
/// not filled yet.
[[nodiscard]] FootOffsets planted_offsets(std::span<const PlantedFoot> plants, int foot,
                                          const LegTrack& leg);

/// Rotates the foot about its toes where these are down and the leg would be stretched too far.
/// @param drops  how far the hips are lowered, per frame.
/// @param ramp   number of frames with the toes down after which the full rotation is allowed.
void rise_on_toes(FootOffsets& offsets, std::span<const PlantedFoot> plants, int foot,
                  const LegTrack& leg, const std::vector<double>& drops, int ramp);

/// Fades the corrections before, between and after the planted runs as described at plant_feet.
/// @param release  length of the fade, frames.
void fade_offsets(FootOffsets& offsets, int release);

}  // namespace retarget
