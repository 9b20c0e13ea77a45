#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/limbs.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/robot.h"

namespace retarget {

/// A joint of a hand. Its link has its origin on the joint's axis, which is the link's z axis
/// (KinematicTree).
struct HandJoint {
  int joint = 0;           ///< Index into Robot::joints().
  int parent = -1;         ///< Index into RobotHand::joints, a smaller one; -1: the palm.
  Pose parent_from_joint;  ///< With the joint at `reference`; metres.
  bool slides = false;
  double reference = 0.0;
  int variable = 0;  ///< What moves it: its position is ratio * variable + offset.
  double ratio = 1.0;
  double offset = 0.0;
};

/// A finger, from the palm to its tip.
struct RobotFinger {
  Finger finger = Finger::kThumb;
  std::vector<int> joints;  ///< Indices into RobotHand::joints, outwards.
  /// Those of `joints` where the line from knuckle to tip has its corners; the first is the knuckle.
  std::vector<int> corners;
  /// The middle of the tip's end, in the link of the last joint, and how far the skin is from it.
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  double tip_radius = 0.0;
  double length = 0.0;  ///< Along the line, metres.
};

/// What hangs from the last joint of an arm and has two fingers at least.
struct RobotHand {
  Side side = Side::kLeft;
  int palm_body = 0;  ///< The body that the arm's last joint moves.
  /// Of the palm link: columns are where straight fingers point, across to the thumb's side, and
  /// out of the palm. Of the right hand a mirror image of the left one's, so of determinant -1.
  Eigen::Matrix3d palm_axes = Eigen::Matrix3d::Identity();
  std::vector<HandJoint> joints;     ///< All that hang from the palm, parents first.
  std::vector<RobotFinger> fingers;  ///< In the order of Finger, each once.
  std::vector<int> variables;  ///< The joints that move freely, by index into Robot::joints().
  bool is_gripper = false;     ///< Two jaws: the thumb and the index finger.
  double opening = 0.0;        ///< Of a gripper: how far its jaws come apart, metres.

  [[nodiscard]] const RobotFinger* find(Finger finger) const;
};

/// Left and right hand; empty where an arm ends without fingers, or with fingers that a variant holds.
using RobotHands = std::array<std::optional<RobotHand>, 2>;

/// Finds the hands of a robot by its tree: whatever branches off behind the arm's last joint is a finger.
/// Which finger a branch is its names say; where they do not, the thumb is the branch that points another
/// way than the others or begins nearer to the wrist, and the others follow from its side on. Two branches
/// without names are a gripper. Fingers bend to the side to which their ranges let them.
/// Couplings are those of the profile (RobotProfile::coupled_joints).
[[nodiscard]] RobotHands find_hands(const Robot& robot, const RobotAnatomy& anatomy);

/// The same of a robot whose anatomy nobody looked for; none where it has no limbs.
[[nodiscard]] RobotHands find_hands(const Robot& robot);

}  // namespace retarget
