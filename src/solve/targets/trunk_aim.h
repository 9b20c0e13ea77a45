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

/// A robot's trunk in its zero configuration: world axes, origin at the middle of the hips, metres.
struct RobotTrunk {
  /// A hinge between the body that follows Hips and the body that follows Spine2.
  struct Waist {
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< Axis of the torso's rotation relative to
                                                       ///< the pelvis.
    Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< A point on the axis.
    double lower = 0.0, upper = 0.0;  ///< Range relative to the zero configuration, radians.
  };
  std::vector<Waist> waist;  ///< Joints from the pelvis upwards.
  TrunkLines lines;
  Eigen::Vector3d hip_line = Eigen::Vector3d::Zero();  ///< Vector from the right hip to the left
                                                       ///< one.
  Eigen::Quaterniond world_from_pelvis = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond world_from_torso = Eigen::Quaterniond::Identity();
};

/// The task of the torso: that of Spine2, else Spine1, else Spine; null without such a task.
[[nodiscard]] const ConfigTask* torso_task(const ResolvedConfig& config);

/// Measures the trunk of a robot. Empty if the configuration has no body for Hips or the waist has
/// more than six hinges.
/// @param limits  joint limits of the run, which determine the ranges of the waist joints.
[[nodiscard]] std::optional<RobotTrunk> robot_trunk(const Robot& robot,
                                                    const ResolvedConfig& config,
                                                    const RobotLimbs& limbs,
                                                    const LimitSet& limits);

/// Computes the rotations of a robot's pelvis and torso with which its trunk leans and turns like
/// the human's.
///
/// R is the rotation from the standing human's trunk_frame() (of standing_trunk_lines()) to that of
/// a frame. The targets of the robot's chord c and shoulder line s in its zero configuration are R
/// c and R s. Pelvis rotation P and waist positions q minimise
///
///     |unit(chord(P, q)) - unit(R c)|^2 + 0.25 |unit(across(P, q)) - unit(R s)|^2
///       + 0.04 |log(P R_Hips^-1)|^2
///
/// with q inside the joint ranges reduced by 5 % on either side. This distributes the bend over the
/// available joints, and no waist joint reaches its limit. Each frame takes Gauss-Newton steps with
/// an active set from P = R_Hips and q = 0, so that frames are independent.
class TrunkAim {
 public:
  /// @param standing        lines of the human's trunk while it stands straight.
  /// @param hips_to_pelvis  rotation of the pelvis in the axes of the Hips bone: the
  ///     configuration's rotation offset.
  TrunkAim(RobotTrunk robot, const TrunkLines& standing, const Eigen::Quaterniond& hips_to_pelvis);

  /// Adapts to the human of a robot, so that the robot reproduces its own waist positions: uses the
  /// shoulder line of the frame itself, because a hinge far from the hips tilts the chord, and lets
  /// the waist use its full ranges.
  void follow_robot();

  /// Pose of the robot's trunk.
  struct Aimed {
    Eigen::Quaterniond world_from_pelvis, world_from_torso;
    /// Lines of the robot, world axes, metres: middle of the hips to middle of the shoulders; right
    /// hip to left hip.
    Eigen::Vector3d chord, hip_line;
  };
  /// Smallest step of the search for targets, rad. The rotations change by a tenth of it.
  static constexpr double kExact = 1e-6;
  /// Solves a frame. Empty for a degenerate trunk, for example if all bones coincide. Contains
  /// non-finite values if a step was not finite; solvers reject such targets.
  /// @param min_step  the search ends at a step below this angle, rad.
  [[nodiscard]] std::optional<Aimed> aim(const HumanPose& world_from_bone,
                                         double min_step = kExact) const;

 private:
  RobotTrunk robot_;  // In the axes of the canonical T-pose.
  Eigen::Matrix3d standing_from_world_ = Eigen::Matrix3d::Identity();
  bool usable_ = false;
  bool of_robot_ = false;
};

}  // namespace retarget
