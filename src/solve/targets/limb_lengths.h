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

/// Lengths of body parts, metres. Legs and arms are means of both sides.
struct LimbLengths {
  double leg = 0.0;    ///< Hip to knee to ankle.
  double arm = 0.0;    ///< Shoulder to elbow to wrist; without forearms, shoulder to elbow.
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
  /// Height of the ankles above the soles in the zero configuration, metres; empty without soles.
  std::optional<double> ankle_height;
  /// Mid-points of the hip joints and of the shoulder joints, and vectors from the right to the
  /// left ones; zero configuration, world, metres.
  Eigen::Vector3d hip_centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d shoulder_centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d hip_line = Eigen::Vector3d::Zero();
  Eigen::Vector3d shoulder_line = Eigen::Vector3d::Zero();
};

/// Hint of errors about limbs that cannot be measured.
inline constexpr const char* kOtherScaleHint = "scale with " OPTION("scale") " table or height";

/// The bones that human_limb_lengths() requires.
inline constexpr std::array kMeasuredBones = {
    Bone::kHips,        Bone::kLeftUpLeg,    Bone::kLeftLeg,    Bone::kLeftFoot, Bone::kLeftArm,
    Bone::kLeftForeArm, Bone::kLeftHand,     Bone::kRightUpLeg, Bone::kRightLeg, Bone::kRightFoot,
    Bone::kRightArm,    Bone::kRightForeArm, Bone::kRightHand};

/// Limb lengths of a human in one frame. The trunk length is the sum along the spine.
/// @param world_from_bone  reads only kMeasuredBones and the spine.
/// @param forearms         whether arms extend to the wrists, as in RobotLimbs::forearms.
[[nodiscard]] LimbLengths human_limb_lengths(const HumanPose& world_from_bone,
                                             bool forearms = true);

/// Measures the limbs of a robot in its zero configuration.
///
/// Knees and elbows are the joints of the bodies that the configuration assigns to `Leg` and
/// `ForeArm`. A hip consists of the joints between the last body that carries both knees and the
/// knee; a shoulder likewise. Ankles and wrists consist of the joints between knee or elbow and the
/// bodies that follow foot or hand. The centre of several hinges is the point nearest to all axes
/// (least squares, with a small weight on the distance to the anchors for parallel axes). If
/// neither hand has a body, arms end at the elbow.
///
/// Errors (kConfig): the configuration has no body for one of these bones, the bodies of a limb do
/// not form a chain, or a limb has zero length.
[[nodiscard]] Result<RobotLimbs> robot_limbs(const Robot& robot, const ResolvedConfig& config);

/// Measures only the arms, for an upper body without legs. Trunk and hips of the result are unset.
/// Errors: those of robot_limbs().
[[nodiscard]] Result<RobotLimbs> robot_arms(const Robot& robot, const ResolvedConfig& config);

/// Leg length as in robot_limbs(), metres. Also works for robots whose arms cannot be measured.
[[nodiscard]] Result<double> robot_leg_length(const Robot& robot, const ResolvedConfig& config);

}  // namespace retarget
