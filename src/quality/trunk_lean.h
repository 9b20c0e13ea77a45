#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "human/human_clip.h"
#include "pipeline/trunk_lines.h"
#include "quality/body_tracks.h"
#include "quality/draft.h"
#include "retarget/human.h"

namespace retarget {

/// The bones that begin at hips and shoulders.
inline constexpr std::array kTrunkBones = {Bone::kLeftUpLeg, Bone::kRightUpLeg, Bone::kLeftArm,
                                           Bone::kRightArm};

/// Whether the hips, both hip joints and both shoulders are there.
[[nodiscard]] bool has_trunk(const HumanClipInfo& human);

/// The trunk's axes when the body stands (standing_trunk_lines); nothing: it has no trunk.
[[nodiscard]] std::optional<Eigen::Matrix3d> standing_trunk(const HumanClip& human);

/// The direction that is up when the body stands, carried by its trunk: R R_standing^T z.
[[nodiscard]] inline Eigen::Vector3d trunk_up(const Eigen::Matrix3d& trunk,
                                              const Eigen::Matrix3d& standing) {
  return trunk * standing.transpose() * Eigen::Vector3d::UnitZ();
}

/// Where a robot's hips and shoulders are, in the order of kTrunkBones.
struct TrunkBodies {
  std::array<int, 4> bodies{};  ///< Indices among the kept bodies of its tracks.
  std::array<Eigen::Vector3d, 4> body_from_joint;
};

/// How far both trunks lean from the vertical, each from its own standing pose: the human's is that
/// of standing_trunk_lines, the robot's the zero configuration. Nothing of bodies without a trunk.
/// @param robot_from_human  a yaw.
/// @param frames            of both.
void measure_trunk_lean(const ReportBuilder& draft, const BodyTracks& tracks,
                        const TrunkBodies& trunk, const HumanClip& human,
                        const Eigen::Quaterniond& robot_from_human, int frames);

}  // namespace retarget
