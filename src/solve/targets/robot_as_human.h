#pragma once

#include <vector>

#include "human/skeleton/robot_human.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/kinematic_tree.h"
#include "retarget/motion.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// Converts a robot to the canonical human: the inverse of a TargetBuilder.
///
/// The rotation of a bone is R_body r^-1, with the body that follows the bone and the rotation
/// offset r of its task in the retargeting configuration. Hips, knees, ankles, shoulders, elbows
/// and wrists are the joint positions of robot_limbs; as in TargetBuilder, hips are fixed to the
/// pelvis and shoulders to the torso. The human therefore has the robot's lengths, and a robot that
/// follows its own human reproduces its own motion.
///
/// Missing parts: a missing torso turns with the pelvis, head and neck with the torso, and hands
/// with the forearms, whose share of the arm is then a human's. Spine, Spine1 and Spine2 are at the
/// common point of the waist joints. Toes are at the toes of the soles or, without soles, at a
/// human's distance ahead of the ankles.
class RobotAsHuman {
 public:
  /// Errors (kConfig): those of robot_limbs; no body follows the hips.
  [[nodiscard]] static Result<RobotAsHuman> make(const Robot& robot, const ResolvedConfig& config);

  /// @param motion  motion of that robot. It must outlive the result, and so must this object.
  [[nodiscard]] RobotHuman human_of(const RobotClip& motion) const;

 private:
  // The bodies that determine a bone's rotation and position.
  struct Part {
    Bone bone = Bone::kHips;
    int turning = 0, carrying = 0;  // Indices of bodies.
    Eigen::Quaterniond turning_from_bone;
    Eigen::Vector3d place;  // In the carrying body, metres.
  };
  void pose(const TreeState& posed, HumanPose& world_from_bone) const;

  std::vector<Part> parts_;
  std::array<std::optional<FootSole>, 2> soles_;
};

}  // namespace retarget
