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

/// Lengths of a body's parts, metres; of legs and arms the mean of both sides.
struct LimbLengths {
  double leg = 0.0;    ///< Hip to knee to ankle.
  double arm = 0.0;    ///< Shoulder to elbow to wrist; of an arm that ends at the elbow, to there.
  double trunk = 0.0;  ///< Middle of the hips to the middle of the shoulders.
};

/// A robot's limbs as its tree and a retargeting configuration tell them.
struct RobotLimbs {
  LimbLengths lengths;
  bool forearms = true;  ///< False: nothing follows the hands, lengths.arm ends at the elbows.
  /// Where the joint that a bone begins at lies in the frame of the body that follows the bone,
  /// metres; of Hips the middle of the hips. Zero for the bones outside legs and arms.
  BoneArray<Eigen::Vector3d> body_from_joint{Eigen::Vector3d(Eigen::Vector3d::Zero())};
  /// Of the ankles over the soles in the zero configuration, metres; nothing without soles.
  std::optional<double> ankle_height;
  /// In the zero configuration, metres, world: the middles of both hips and both shoulders, and the
  /// ways from the right hip and shoulder to the left ones.
  Eigen::Vector3d hip_centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d shoulder_centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d hip_line = Eigen::Vector3d::Zero();
  Eigen::Vector3d shoulder_line = Eigen::Vector3d::Zero();
};

/// What a user can do whose human or robot has no limbs to measure.
inline constexpr const char* kOtherScaleHint = "scale with " OPTION("scale") " table or height";

/// The bones without which a human's limbs cannot be measured.
inline constexpr std::array kMeasuredBones = {
    Bone::kHips,        Bone::kLeftUpLeg,    Bone::kLeftLeg,    Bone::kLeftFoot, Bone::kLeftArm,
    Bone::kLeftForeArm, Bone::kLeftHand,     Bone::kRightUpLeg, Bone::kRightLeg, Bone::kRightFoot,
    Bone::kRightArm,    Bone::kRightForeArm, Bone::kRightHand};

/// Lengths of a human, from the bones of one frame; the trunk's is summed along the spine.
/// @param world_from_bone  those of kMeasuredBones and the spine count.
/// @param forearms         whether arms go beyond the elbow, as RobotLimbs::forearms has it.
[[nodiscard]] LimbLengths human_limb_lengths(const HumanPose& world_from_bone,
                                             bool forearms = true);

/// Measures a robot in its zero configuration.
///
/// A ball joint that is built of hinges one after the other has its centre where their axes come
/// nearest to each other (least squares, drawn slightly towards the anchors where axes are
/// parallel). Hips are the joints between the last body that both knees hang from and the knee;
/// shoulders likewise; ankles and wrists those from there to the bodies that follow foot and hand. Knees and
/// elbows are the joints of the bodies that the configuration gives to `Leg` and `ForeArm`. Where
/// neither hand has a body, arms are measured to the elbow.
///
/// kConfig error: the configuration has no body for one of these, they do not follow each other, or
/// a limb has no length.
[[nodiscard]] Result<RobotLimbs> robot_limbs(const Robot& robot, const ResolvedConfig& config);

/// The arms alone, of an upper body: no legs, no trunk, nothing of hips. Errors as robot_limbs.
[[nodiscard]] Result<RobotLimbs> robot_arms(const Robot& robot, const ResolvedConfig& config);

/// Length of the legs alone, as robot_limbs has it; also of a robot whose arms cannot be measured.
[[nodiscard]] Result<double> robot_leg_length(const Robot& robot, const ResolvedConfig& config);

}  // namespace retarget
