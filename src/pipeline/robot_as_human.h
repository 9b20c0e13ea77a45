#pragma once

#include <span>
#include <vector>

#include "human/robot_human.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// A robot as the canonical human: the inverse of what a TargetBuilder does.
///
/// The body that follows a bone (its task in the retargeting configuration, with the rotation offset
/// r) gives its rotation, R_body r^-1. Hips, knees, ankles, shoulders, elbows and wrists are where
/// robot_limbs has them, hips fixed to the pelvis and shoulders to the torso, as TargetBuilder takes
/// them. So the human has the robot's lengths, and a robot that follows its own human is asked for
/// its own motion.
///
/// Where the robot lacks a part: a torso turns with the pelvis, head and neck with the torso, hands
/// with the forearms, which have a human's share of the arm then. The joints of the waist meet where
/// Spine, Spine1 and Spine2 are. Toes are where the soles' toes are, else a human's way ahead.
class RobotAsHuman {
 public:
  /// Errors (kConfig): robot_limbs'; no body follows the hips.
  [[nodiscard]] static Result<RobotAsHuman> make(const Robot& robot, const ResolvedConfig& config);

  /// A motion of that robot, which must outlive the result as this must.
  [[nodiscard]] RobotHuman human_of(const RobotClip& motion) const;

 private:
  // what a bone turns with, and what it begins at a place of
  struct Part {
    Bone bone = Bone::kHips;
    int turning = 0, carrying = 0;  // bodies
    Eigen::Quaterniond turning_from_bone;
    Eigen::Vector3d place;  // in the carrying body, metres
  };
  void pose(const TreeState& posed, HumanPose& world_from_bone) const;

  std::vector<Part> parts_;
  std::array<std::optional<FootSole>, 2> soles_;
};

}  // namespace retarget
