#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/pose.h"
#include "robot/anatomy/robot_hands.h"
#include "solve/hands/hand_target.h"

namespace retarget {

/// Positions of the joints of a robot's hand in its palm link. Does not allocate after
/// construction.
class HandPosture {
 public:
  /// @param hand  must outlive this object.
  explicit HandPosture(const RobotHand& hand) : hand_(hand), palm_from_joint_(hand.joints.size()) {}

  /// @param positions  positions of RobotHand::joints, rad or m.
  void set(const Eigen::VectorXd& positions) {
    set_from([&](std::size_t i) { return positions[static_cast<Eigen::Index>(i)]; });
  }
  /// @param variables  values of RobotHand::variables, rad or m.
  void set_variables(const Eigen::VectorXd& variables) {
    set_from([&](std::size_t i) {
      const HandJoint& joint = hand_.joints[i];
      return joint.ratio * variables[joint.variable] + joint.offset;
    });
  }

  [[nodiscard]] const Pose& palm_from_joint(int joint) const {
    return palm_from_joint_[static_cast<std::size_t>(joint)];
  }
  [[nodiscard]] Eigen::Vector3d tip(const RobotFinger& finger) const {
    return palm_from_joint(finger.joints.back()) * finger.tip;
  }
  /// Point k of a finger's line (its corners, then its tip), and the joint that carries it.
  [[nodiscard]] Eigen::Vector3d point(const RobotFinger& finger, int k, int& joint) const;
  /// Distance from the thumb's tip to a finger's tip, skin to skin, metres; negative if they
  /// overlap.
  /// @pre the hand has a thumb.
  [[nodiscard]] double gap(const RobotFinger& finger) const;
  /// Directions of a finger's parts, unit vectors in the palm's axes.
  void directions(const RobotFinger& finger, HandTarget::Parts& parts) const;

 private:
  template <typename Position>
  void set_from(const Position& position) {
    for (std::size_t i = 0; i < hand_.joints.size(); ++i) set_joint(i, position(i));
  }
  void set_joint(std::size_t index, double position);

  const RobotHand& hand_;
  std::vector<Pose> palm_from_joint_;
};

}  // namespace retarget
