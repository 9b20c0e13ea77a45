#pragma once

#include <vector>

#include "human/skeleton/robot_human.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/kinematic_tree.h"
#include "retarget/motion.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// Converts a robot to the canonical human: the inverse of a TargetBuilder.
///
/// The rotation of a bone is R_body r^-1, where r is the rotation offset of the task of the body
/// that follows the bone. Hips, knees, ankles, shoulders, elbows and wrists are at the joint
/// positions of robot_limbs(). As in TargetBuilder, hips are fixed to the pelvis and shoulders to
/// the torso. The human therefore has the robot's limb lengths, and a robot that follows its own
/// human reproduces its own motion.
///
/// Parts that the robot lacks: a torso rotates with the pelvis, head and neck with the torso, hands
/// with the forearms. Forearms without a hand have a human's share of the arm length. Spine, Spine1
/// and Spine2 are at the common point of the waist joints. Toes are at the toes of the soles or,
/// without soles, ahead of the ankles at a human's distance.
class RobotAsHuman {
 public:
  /// The origin of a bone's pose.
  struct Part {
    Bone bone = Bone::kHips;
    int turning = 0, carrying = 0;  ///< Bodies that determine the rotation and the position.
    Eigen::Quaterniond turning_from_bone;
    Eigen::Vector3d place;  ///< Position in the frame of the body `carrying`, metres.
  };

  /// Errors (kConfig): those of robot_limbs; no body follows the hips.
  [[nodiscard]] static Result<RobotAsHuman> make(const Robot& robot, const ResolvedConfig& config);

  /// The human of a motion. The motion and this object must outlive the result.
  /// @param motion  a motion of the robot.
  [[nodiscard]] RobotHuman human_of(const RobotClip& motion) const;

 private:
  void pose(const TreeState& posed, HumanPose& world_from_bone) const;

  std::vector<Part> parts_;
  std::array<std::optional<FootSole>, 2> soles_;
};

}  // namespace retarget
