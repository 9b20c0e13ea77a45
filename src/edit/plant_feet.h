#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "human/contact_plan.h"
#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// The joints of a leg, each below the one before.
struct LegJoints {
  int hip = -1, knee = -1, ankle = -1;
};

/// The legs of a body, left and right; nothing for one that is not whole, or whose joints do not
/// hang from each other.
[[nodiscard]] std::array<std::optional<LegJoints>, 2> find_legs(const Skeleton& skeleton,
                                                                const Calibration& calibration);

/// A leg frame by frame before its foot is moved: the canonical human's world, metres.
struct LegTrack {
  std::vector<Pose> ankles;           ///< The ankle joint's.
  std::vector<Eigen::Vector3d> hips;  ///< Where the thigh begins.
  std::vector<double> lengths;        ///< Of thigh and shin.
};

/// Of every frame.
[[nodiscard]] LegTrack track_leg(const Clip& clip, const Calibration& calibration,
                                 const LegJoints& leg);

/// World poses of a leg's ankle (the file's joint and its axes), metres, z up, every frame.
[[nodiscard]] std::vector<Pose> ankle_poses(const Clip& clip, const Calibration& calibration,
                                            const LegJoints& leg);

/// What of a foot is on the floor.
enum class FootStance : std::uint8_t { kOnHeel, kOnSole, kOnToes };

/// Where a foot has to stand, and when.
struct PlantedFoot {
  int foot = 0;                       ///< 0: left, 1: right.
  int begin = 0;                      ///< First frame.
  std::vector<Pose> world_from_foot;  ///< One per frame: the ankle joint's, as ankle_poses.
  /// One per frame; empty: on its sole all the time. A foot whose toes are down may turn about them
  /// where its leg would be too short.
  std::vector<FootStance> stances = {};
  /// Where the toes begin in the ankle joint's frame, metres; nothing: they are not known.
  std::optional<Eigen::Vector3d> toes_in_foot = std::nullopt;

  [[nodiscard]] int end() const { return begin + static_cast<int>(world_from_foot.size()); }
};

/// Brings feet to where they have to stand, in place.
///
/// The way from where a foot is to where it has to be is known in the frames in which it is
/// planted; before and after it fades (a cubic with continuous velocity), between two places that
/// are near in time it goes from the one to the other. Each leg then follows its foot by two-bone
/// inverse kinematics: the knee opens or closes in its own plane, the hip turns by the least
/// rotation, the foot keeps the pose that was asked for. Where a leg would be too short a foot on
/// its toes turns about them, and the hips are lowered, smoothly; the last few per cent of its
/// stretch a leg takes less and less. Frames without a correction keep every bit.
///
/// @param plants  of each foot in order of time, without overlap; feet without a leg are left out.
/// @return kInput errors as BodyMover::of.
[[nodiscard]] Result<PlantSummary> plant_feet(Clip& clip, const Calibration& calibration,
                                              std::span<const PlantedFoot> plants,
                                              const PlantOptions& options);

/// What was done to plant feet, for people.
[[nodiscard]] std::string planted_text(const PlantSummary& feet);

/// Contacts with breaks shorter than `seconds` closed: no step is as short, the foot stands on.
[[nodiscard]] std::vector<ContactPhase> without_short_breaks(
    const std::vector<ContactPhase>& phases, double seconds, const FrameRate& rate);

}  // namespace retarget
