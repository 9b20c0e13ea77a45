#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/robot.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// Joints of a branch from its first link outwards. Where it forks, the side with more joints is
/// followed, but a branch of four joints or more ends there (a hand with fingers) unless one side
/// outweighs the others (rods beside a shin), and so it does at a slide (a gripper).
[[nodiscard]] std::vector<int> joint_chain(const Robot& robot, int first);

/// Two branches of one body that are mirror images of each other.
struct BranchPair {
  int parent = 0;                            ///< Link.
  int first = 0, second = 0;                 ///< Their first links.
  Eigen::Vector3d across = {0.0, 1.0, 0.0};  ///< From second to first: the y or the x axis.
  double lowest = 0.0;                       ///< Height of the lowest joint.
  int joint_count = 0;                       ///< Of one branch's chain.
};

/// The pairs that hang from the trunk: from the root, or from what hangs from it and carries pairs.
[[nodiscard]] std::vector<BranchPair> branch_pairs(const Robot& robot, const TreeState& posed);

}  // namespace retarget
