#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "human/skeleton/human_clip.h"
#include "judge/quality/body_tracks.h"
#include "judge/quality/draft.h"
#include "judge/quality/posture.h"
#include "retarget/human.h"
#include "solve/targets/trunk_lines.h"

namespace retarget {

/// The bones that start at the hips and shoulders.
inline constexpr std::array kTrunkBones = {Bone::kLeftUpLeg, Bone::kRightUpLeg, Bone::kLeftArm,
                                           Bone::kRightArm};

/// Whether the hips, both hip joints and both shoulders exist.
[[nodiscard]] bool has_trunk(const HumanClipInfo& human);

/// Axes of the standing trunk (standing_trunk_lines); nothing without a trunk.
[[nodiscard]] std::optional<Eigen::Matrix3d> standing_trunk(const HumanClip& human);

/// Up direction of the standing pose, fixed to the trunk: R R_standing^T z.
[[nodiscard]] inline Eigen::Vector3d trunk_up(const Eigen::Matrix3d& trunk,
                                              const Eigen::Matrix3d& standing) {
  return trunk * standing.transpose() * Eigen::Vector3d::UnitZ();
}

/// A robot's hips and shoulders, in the order of kTrunkBones.
struct TrunkBodies {
  std::array<int, 4> bodies{};  ///< Indices among the kept bodies.
  std::array<Eigen::Vector3d, 4> body_from_joint;
};

/// Measures how far both trunks lean from the vertical while the body is upright, relative to their
/// standing poses. The human's standing pose comes from standing_trunk_lines, the robot's is the
/// zero configuration. Adds nothing for bodies without a trunk.
/// @param robot_from_human  a yaw.
/// @param frames            number of frames of both.
void measure_trunk_lean(const ReportBuilder& draft, const BodyTracks& tracks,
                        const TrunkBodies& trunk, const HumanClip& human,
                        const Eigen::Quaterniond& robot_from_human, const Posture& posture,
                        int frames);

}  // namespace retarget
