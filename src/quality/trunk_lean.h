#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "quality/body_tracks.h"
#include "quality/draft.h"
#include "retarget/human/human_clip.h"

namespace retarget {

/// The bones that begin at hips and shoulders, in the order of TrunkJoints.
inline constexpr std::array<std::string_view, 4> kTrunkBones = {"LeftUpLeg", "RightUpLeg",
                                                                "LeftArm", "RightArm"};

/// The joints that a trunk lies between; world, metres.
struct TrunkJoints {
  Eigen::Vector3d left_hip = Eigen::Vector3d::Zero();
  Eigen::Vector3d right_hip = Eigen::Vector3d::Zero();
  Eigen::Vector3d left_shoulder = Eigen::Vector3d::Zero();
  Eigen::Vector3d right_shoulder = Eigen::Vector3d::Zero();

  /// From the middle of the hips to the middle of the shoulders.
  [[nodiscard]] Eigen::Vector3d line() const {
    return 0.5 * (left_shoulder + right_shoulder - left_hip - right_hip);
  }
};

/// World from trunk, a rotation whose columns are its axes: Z along the line, Y to the left (hip
/// and shoulder line together, made square to Z), X forward. Nothing where the joints coincide.
[[nodiscard]] std::optional<Eigen::Matrix3d> trunk_axes(const TrunkJoints& joints);

/// The joints of a human's trunk in a frame. @pre has_trunk
[[nodiscard]] TrunkJoints human_trunk(std::span<const Pose> world_from_bone);

/// Whether the hips, both hip joints and both shoulders are there.
[[nodiscard]] bool has_trunk(const HumanClipInfo& human);

/// The axes of a human's trunk in the canonical T-pose: every bone turned as canonical_t_pose says,
/// at its mean place in the frame of the bone before it. A skeleton's hips and shoulders are where
/// its maker put them, so that the line is seldom vertical there: of LAFAN1's it leans back by 6.6
/// degrees. Nothing for a body without a trunk.
[[nodiscard]] std::optional<Eigen::Matrix3d> standing_trunk(const HumanClip& human);

/// The direction that is up when the body stands, carried by its trunk: R R_standing^T z.
[[nodiscard]] inline Eigen::Vector3d trunk_up(const Eigen::Matrix3d& trunk,
                                              const Eigen::Matrix3d& standing) {
  return trunk * standing.transpose() * Eigen::Vector3d::UnitZ();
}

/// Where a robot's hips and shoulders are, in the order of kTrunkBones.
struct RobotTrunk {
  std::array<int, 4> bodies{};  ///< Indices among the kept bodies of its tracks.
  std::array<Eigen::Vector3d, 4> body_from_joint;
};

/// How far both trunks lean from the vertical, each from its own standing pose: the robot's is the
/// zero configuration. Nothing of bodies without a trunk.
/// @param robot_from_human  a yaw.
/// @param frames            of both.
void measure_trunk_lean(const Draft& draft, const BodyTracks& tracks, const RobotTrunk& trunk,
                        const HumanClip& human, const Eigen::Quaterniond& robot_from_human,
                        int frames);

}  // namespace retarget
