#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "pipeline/limb_lengths.h"
#include "pipeline/trunk_lines.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// A robot's trunk in its zero configuration, axes of the world there, metres from the middle of the
/// hips.
struct RobotTrunk {
  /// A joint between the body that follows Hips and the one that follows Spine2.
  struct Waist {
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< Torso against pelvis, right-handed.
    Eigen::Vector3d anchor = Eigen::Vector3d::Zero();
    double lower = 0.0, upper = 0.0;  ///< Radians from the zero configuration.
  };
  std::vector<Waist> waist;  ///< Hinges alone, from the pelvis on.
  TrunkLines lines;
  Eigen::Vector3d hip_line = Eigen::Vector3d::Zero();  ///< From the right hip to the left one.
  Eigen::Quaterniond world_from_pelvis = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond world_from_torso = Eigen::Quaterniond::Identity();
};

/// The task of the torso: of Spine2, else Spine1, else Spine; null: none.
[[nodiscard]] const ConfigTask* torso_task(const ResolvedConfig& config);

/// Nothing for a robot whose configuration has no body for Hips.
/// @param limits  of the run: how far the waist turns.
[[nodiscard]] std::optional<RobotTrunk> robot_trunk(const Robot& robot,
                                                    const ResolvedConfig& config,
                                                    const RobotLimbs& limbs,
                                                    const LimitSet& limits);

/// Where a robot's pelvis and torso should point so that its trunk leans and turns as the human's.
///
/// With R the rotation that takes the standing human's lines (trunk_frame of standing_trunk_lines) to
/// those of a frame, the robot's chord c and shoulder line s of its zero configuration should become
/// R c and R s. Pelvis rotation P and waist positions q minimise
///
///     |unit(chord(P, q)) - unit(R c)|^2 + 0.25 |unit(across(P, q)) - unit(R s)|^2
///       + 0.04 |log(P R_Hips^-1)|^2
///
/// with q inside the ranges less 5 % on either side: the bend is shared by what the robot has, and no
/// waist joint is driven into its limit. Gauss-Newton steps with an active set, from P = R_Hips and
/// q = 0 in every frame, so that no frame depends on another.
class TrunkAim {
 public:
  /// @param standing        lines of the human who stands straight.
  /// @param hips_to_pelvis  rotation of the pelvis in the Hips bone's axes: the configuration's offset.
  TrunkAim(RobotTrunk robot, const TrunkLines& standing, const Eigen::Quaterniond& hips_to_pelvis);

  /// The human is a robot's: its shoulders are as they are, not square to a chord that a hinge far
  /// from the hips has tilted, and its waist uses the whole of its ranges. So a robot is asked for
  /// its own waist.
  void follow_robot();

  struct Aimed {
    Eigen::Quaterniond world_from_pelvis, world_from_torso;
    /// Of the robot, metres: middle of the hips to middle of the shoulders, right hip to left hip.
    Eigen::Vector3d chord, hip_line;
  };
  /// Nothing for a human without a trunk: all bones in one place, say.
  [[nodiscard]] std::optional<Aimed> aim(const HumanPose& world_from_bone) const;

 private:
  RobotTrunk robot_;  // in the axes of the canonical T-pose
  Eigen::Matrix3d standing_from_world_ = Eigen::Matrix3d::Identity();
  bool usable_ = false;
  bool of_robot_ = false;
};

}  // namespace retarget
