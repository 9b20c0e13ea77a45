#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "base/option_name.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// Lengths of body parts, metres; legs and arms are the mean of both sides.
struct LimbLengths {
  double leg = 0.0;    ///< Hip to knee to ankle.
  double arm = 0.0;    ///< Shoulder to elbow to wrist; to the elbow for arms that end there.
  double trunk = 0.0;  ///< Middle of the hips to the middle of the shoulders.
};

/// Limbs of a robot, measured from its kinematic tree and a retargeting configuration.
struct RobotLimbs {
  LimbLengths lengths;
  bool forearms = true;  ///< False if no body follows the hands; lengths.arm then ends at the
                         ///< elbows.
  /// Position of the joint at which a bone begins, in the frame of the body that follows the bone,
  /// metres; for Hips, the middle of the hips. Zero for bones outside legs and arms.
  BoneArray<Eigen::Vector3d> body_from_joint{Eigen::Vector3d(Eigen::Vector3d::Zero())};
  /// Height of the ankles above the soles in the zero configuration, metres; nothing without soles.
  std::optional<double> ankle_height;
  /// Middle of both hips and of both shoulders, and vectors from the right hip and shoulder to the
  /// left ones; zero configuration, world, metres.
  Eigen::Vector3d hip_centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d shoulder_centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d hip_line = Eigen::Vector3d::Zero();
  Eigen::Vector3d shoulder_line = Eigen::Vector3d::Zero();
};

/// Hint for users whose human or robot has no limbs to measure.
inline constexpr const char* kOtherScaleHint = "scale with " OPTION("scale") " table or height";

/// The bones that are required to measure a human's limbs.
inline constexpr std::array kMeasuredBones = {
    Bone::kHips,        Bone::kLeftUpLeg,    Bone::kLeftLeg,    Bone::kLeftFoot, Bone::kLeftArm,
    Bone::kLeftForeArm, Bone::kLeftHand,     Bone::kRightUpLeg, Bone::kRightLeg, Bone::kRightFoot,
    Bone::kRightArm,    Bone::kRightForeArm, Bone::kRightHand};

/// Lengths of a human's limbs, from the bones of one frame. The trunk is summed along the spine.
/// @param world_from_bone  only kMeasuredBones and the spine are read.
/// @param forearms         whether arms extend beyond the elbow, as in RobotLimbs::forearms.
[[nodiscard]] LimbLengths human_limb_lengths(const HumanPose& world_from_bone,
                                             bool forearms = true);

/// Measures a robot in its zero configuration.
///
/// If several hinges form a ball joint, its centre is the point nearest to all axes (least squares,
/// with a small pull towards the anchors for parallel axes). Hips are the joints between the last
/// body that carries both knees and the knee; shoulders are found likewise. Ankles and wrists are
/// the joints from there to the bodies that follow foot and hand. Knees and elbows are the joints
/// of the bodies that the configuration assigns to `Leg` and `ForeArm`. If neither hand has a body,
/// arms are measured to the elbow.
///
/// kConfig error: the configuration has no body for one of these, the bodies do not follow each
/// other, or a limb has no length.
[[nodiscard]] Result<RobotLimbs> robot_limbs(const Robot& robot, const ResolvedConfig& config);

/// Measures only the arms, for an upper body without legs; trunk and hips are not set. Errors as
/// robot_limbs().
[[nodiscard]] Result<RobotLimbs> robot_arms(const Robot& robot, const ResolvedConfig& config);

/// Leg length as in robot_limbs(); also for robots whose arms cannot be measured.
[[nodiscard]] Result<double> robot_leg_length(const Robot& robot, const ResolvedConfig& config);

}  // namespace retarget
