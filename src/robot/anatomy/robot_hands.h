#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// A joint of a hand. The origin of its link is on the joint's axis, which is the link's z axis
/// (KinematicTree).
struct HandJoint {
  int joint = 0;           ///< Index into Robot::joints().
  int parent = -1;         ///< Smaller index into RobotHand::joints; -1: the palm.
  Pose parent_from_joint;  ///< Pose with the joint at `reference`; metres.
  bool slides = false;
  double reference = 0.0;
  int variable = 0;  ///< Index into RobotHand::variables; joint position = ratio * variable +
                     ///< offset.
  double ratio = 1.0;
  double offset = 0.0;
};

/// A finger, from the palm to its tip.
struct RobotFinger {
  Finger finger = Finger::kThumb;
  std::vector<int> joints;  ///< Indices into RobotHand::joints, outwards.
  /// Entries of `joints` at which the line from knuckle to tip has its corners; the first is the
  /// knuckle.
  std::vector<int> corners;
  /// Centre of the fingertip's end in the last joint's link, and its distance from the skin,
  /// metres.
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  double tip_radius = 0.0;
  double length = 0.0;    ///< Length along the line, metres.
  bool is_named = false;  ///< True if a name identifies the finger, false if the shape does.
};

/// A hand: the links beyond an arm's last joint, with at least two fingers.
struct RobotHand {
  Side side = Side::kLeft;
  int palm_body = 0;  ///< The body that the arm's last joint moves.
  /// Columns are the palm axes in the palm link: along straight fingers, towards the thumb's side,
  /// and out of the palm. The right hand mirrors the left one, so its determinant is -1.
  Eigen::Matrix3d palm_axes = Eigen::Matrix3d::Identity();
  std::vector<HandJoint> joints;     ///< All joints below the palm, parents first.
  std::vector<RobotFinger> fingers;  ///< Fingers in the order of Finger, each at most once.
  std::vector<int> variables;        ///< Independent joints, by index into Robot::joints().
  bool is_gripper = false;           ///< True for two jaws, named as thumb and index finger.
  double opening = 0.0;              ///< Largest opening of a gripper's jaws, metres.

  [[nodiscard]] const RobotFinger* find(Finger finger) const;
};

/// Left and right hand; empty if an arm has no fingers or a variant locks them.
using RobotHands = std::array<std::optional<RobotHand>, 2>;

/// Finds a robot's hands from its tree: every branch beyond the arm's last joint is a finger. Body
/// names, then joint names identify the fingers. Without names, the thumb is the branch that points
/// away from the others or begins nearer to the wrist, and the others follow in order from its
/// side. Two unnamed branches form a gripper. Fingers bend to the side that their ranges favour.
/// Couplings come from the profile (RobotProfile::coupled_joints).
[[nodiscard]] RobotHands find_hands(const Robot& robot, const RobotAnatomy& anatomy);

/// Finds the hands of a robot whose anatomy is unknown; returns none if its limbs cannot be found.
[[nodiscard]] RobotHands find_hands(const Robot& robot);

}  // namespace retarget
