#pragma once

#include <array>
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

/// Tracks a leg through all frames.
[[nodiscard]] LegTrack track_leg(const Clip& clip, const Calibration& calibration,
                                 const LegJoints& leg);

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
                                              const PlantOptions& options);

/// Returns the human-readable summary of the corrections.
[[nodiscard]] std::string planted_text(const PlantSummary& feet);

/// Merges contacts separated by less than `seconds`: no step is that short, so the foot stays down.
[[nodiscard]] std::vector<ContactPhase> without_short_breaks(
    const std::vector<ContactPhase>& phases, double seconds, const FrameRate& rate);

}  // namespace retarget
