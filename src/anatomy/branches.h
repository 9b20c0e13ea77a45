#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// A robot in one configuration: where its bodies, joints and axes are in the world.
class PosedRobot {
 public:
  PosedRobot(const Robot& robot, const std::vector<double>& qpos);

  [[nodiscard]] const Robot& robot() const { return *robot_; }
  [[nodiscard]] const Pose& body(int index) const { return world_from_body_[index]; }
  [[nodiscard]] Eigen::Vector3d anchor(int joint) const;
  [[nodiscard]] Eigen::Vector3d axis(int joint) const;
  /// Where the axes of these joints come nearest to each other (least squares, drawn slightly
  /// towards the anchors where axes are parallel).
  [[nodiscard]] Eigen::Vector3d centre_of(const std::vector<int>& joints) const;
  /// Root mean square distance of a point from the axes of these joints.
  [[nodiscard]] double spread_about(const Eigen::Vector3d& point,
                                    const std::vector<int>& joints) const;

 private:
  const Robot* robot_;
  std::vector<Pose> world_from_body_;
};

/// The tree of the bodies that joints move; bodies fixed to one of them count as part of it.
class MovingBodies {
 public:
  explicit MovingBodies(const Robot& robot);

  /// Moving bodies that hang from this moving body (or from the root).
  [[nodiscard]] const std::vector<int>& children(int body) const { return children_[body]; }
  [[nodiscard]] const std::vector<int>& joints(int body) const { return joints_[body]; }
  /// The moving body (or the root) that this body is part of.
  [[nodiscard]] int carrier(int body) const { return carrier_[body]; }
  /// All bodies that are part of this moving body, itself first.
  [[nodiscard]] const std::vector<int>& parts(int body) const { return parts_[body]; }
  [[nodiscard]] int joint_count_below(int body) const;  ///< Its own joints included.

  /// Joints of a branch from its first body outwards. Where it forks, the side with more joints
  /// is followed, but a branch of four joints or more ends there (a hand with fingers), and so it
  /// does at a slide (a gripper).
  [[nodiscard]] std::vector<int> chain(int first) const;

 private:
  const Robot* robot_;
  std::vector<std::vector<int>> children_, joints_, parts_;
  std::vector<int> carrier_;
};

/// Two branches of one body that are mirror images of each other.
struct BranchPair {
  int parent = 0;
  int first = 0, second = 0;                 ///< Their first bodies.
  Eigen::Vector3d across = {0.0, 1.0, 0.0};  ///< From second to first: the y or the x axis.
  double lowest = 0.0;                       ///< Height of the lowest joint.
  int joint_count = 0;                       ///< Of one branch's chain.
};

/// The pairs that hang from the trunk: from the root, or from what hangs from it and carries pairs.
[[nodiscard]] std::vector<BranchPair> branch_pairs(const PosedRobot& posed,
                                                   const MovingBodies& moving);

}  // namespace retarget
