#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "solve/targets/limb_lengths.h"
#include "solve/targets/trunk_lines.h"

namespace retarget {

/// A robot's trunk in its zero configuration, in world axes, metres from the middle of the hips.
struct RobotTrunk {
  /// A joint between the body that follows Hips and the body that follows Spine2.
  struct Waist {
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< Axis of the torso's rotation relative to
                                                      ///< the pelvis.
    Eigen::Vector3d anchor = Eigen::Vector3d::Zero();
    double lower = 0.0, upper = 0.0;  ///< Radians from the zero configuration.
  };
  std::vector<Waist> waist;  ///< Only hinges, from the pelvis upwards.
  TrunkLines lines;
  Eigen::Vector3d hip_line = Eigen::Vector3d::Zero();  ///< From the right hip to the left one.
  Eigen::Quaterniond world_from_pelvis = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond world_from_torso = Eigen::Quaterniond::Identity();
};

/// The task of the torso: that of Spine2, else Spine1, else Spine; null if there is none.
[[nodiscard]] const ConfigTask* torso_task(const ResolvedConfig& config);

/// Returns nothing if the configuration has no body for Hips or the waist has more than six hinges.
/// @param limits  limits of the run, which determine the ranges of the waist joints.
[[nodiscard]] std::optional<RobotTrunk> robot_trunk(const Robot& robot,
                                                    const ResolvedConfig& config,
                                                    const RobotLimbs& limbs,
                                                    const LimitSet& limits);

/// Computes rotations of a robot's pelvis and torso so that its trunk leans and turns as the
/// human's.
///
/// R is the rotation that takes the standing human's lines (trunk_frame of standing_trunk_lines) to
/// those of a frame. The robot's chord c and shoulder line s of its zero configuration should then
/// become R c and R s. Pelvis rotation P and waist positions q minimise
///
///     |unit(chord(P, q)) - unit(R c)|^2 + 0.25 |unit(across(P, q)) - unit(R s)|^2
///       + 0.04 |log(P R_Hips^-1)|^2
///
/// with q inside the joint ranges less 5 % on either side. The bend is distributed over the
/// available joints, and no waist joint is driven into its limit. Each frame takes Gauss-Newton
/// steps with an active set from P = R_Hips and q = 0, so that frames are independent.
class TrunkAim {
 public:
  /// @param standing        lines of the human who stands straight.
  /// @param hips_to_pelvis  rotation of the pelvis in the axes of the Hips bone: the
  ///     configuration's offset.
  TrunkAim(RobotTrunk robot, const TrunkLines& standing, const Eigen::Quaterniond& hips_to_pelvis);

  /// Adapts to the human of a robot. Its shoulder line is used as it is, because a hinge far from
  /// the hips tilts the chord; its waist may use its whole ranges. A robot then reproduces its own
  /// waist positions.
  void follow_robot();

  struct Aimed {
    Eigen::Quaterniond world_from_pelvis, world_from_torso;
    /// Of the robot, metres: middle of the hips to middle of the shoulders; right hip to left hip.
    Eigen::Vector3d chord, hip_line;
  };
  /// Returns nothing for a degenerate trunk, for example if all bones coincide. Returns non-finite
  /// values if a step was not finite; solvers reject such targets.
  [[nodiscard]] std::optional<Aimed> aim(const HumanPose& world_from_bone) const;

 private:
  RobotTrunk robot_;  // In the axes of the canonical T-pose.
  Eigen::Matrix3d standing_from_world_ = Eigen::Matrix3d::Identity();
  bool usable_ = false;
  bool of_robot_ = false;
};

}  // namespace retarget
