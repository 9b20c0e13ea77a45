#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/robot.h"

namespace retarget {

/// Whether each body has a shape (Robot::collision_shapes).
[[nodiscard]] std::vector<bool> bodies_with_shapes(const Robot& robot);

/// Returns the pairs of moving bodies at most two joints apart in the tree. They overlap by design,
/// so their contact is allowed. Bodies fixed to such a body follow if they have shapes
/// (Robot::collision_shapes). The body nearer to the root comes first.
[[nodiscard]] std::vector<std::pair<int, int>> neighbours(const Robot& robot);

/// Returns the joints of a branch from its first link outwards. At a fork the chain follows the
/// side with more joints. A chain of four joints or more ends at a fork (a hand with fingers)
/// unless one side outweighs the others (rods next to a shin). A chain also ends at a slide (a
/// gripper).
[[nodiscard]] std::vector<int> joint_chain(const Robot& robot, int first);

/// Returns the joint of the first slide in a branch, in the order of the tree.
[[nodiscard]] std::optional<int> first_slide(const Robot& robot, int first);

/// Two branches of one body that are mirror images of each other.
struct BranchPair {
  int parent = 0;                            ///< Index of the parent link.
  int first = 0, second = 0;                 ///< First links of the two branches.
  Eigen::Vector3d across = {0.0, 1.0, 0.0};  ///< Unit direction from second to first: the y axis,
                                             ///< the x axis, or a horizontal direction.
  double lowest = 0.0;                       ///< Height of the lowest joint.
  int joint_count = 0;                       ///< Joints that the chains of both have in common.
};

/// Returns the joints of a paired branch: its chain, without fingers that only this side's chain
/// follows.
[[nodiscard]] std::vector<int> joint_chain(const Robot& robot, const BranchPair& pair, int first);

/// Returns the pairs attached to the trunk: to the root, or to links attached to it that carry
/// pairs.
[[nodiscard]] std::vector<BranchPair> branch_pairs(const Robot& robot, const TreeState& posed);

/// A limb or joint that is on one side only, or that the other side has in another zero pose.
struct OneSided {
  std::string fault, hint;
};

/// Explains which limb or joint lacks a counterpart on the other side; nothing if all have one. Two
/// branches of one body that mirror each other up to a joint are the same limb. A branch on its own
/// is a limb if it is beside the trunk, as seen by the pairs that were found. Two such branches
/// with the same number of joints, one on either side, are limbs whose zero poses differ.
/// @param pairs  result of branch_pairs.
[[nodiscard]] std::optional<OneSided> missing_counterpart(const Robot& robot,
                                                          const TreeState& posed,
                                                          const std::vector<BranchPair>& pairs);

}  // namespace retarget
