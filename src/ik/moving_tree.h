#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "retarget/pose.h"
#include "retarget/robot.h"

namespace retarget {

/// A robot's kinematic tree with everything that does not move folded away: one node per joint
/// that carries one of the bodies of interest, the z axis of the node's frame along the joint's
/// axis, its origin at the joint's anchor.
///
/// Degrees of freedom are numbered anew: 0-2 the root's position in the world, 3-5 its rotation
/// in its own axes, then the nodes, parents first and each subtree without gaps.
class MovingTree {
 public:
  static constexpr int kBase = -1;   ///< The parent of nodes that hang on the root body.
  static constexpr int kWorld = -2;  ///< Stands for bodies that do not move at all.
  static constexpr int kBaseDofs = 6;

  struct Node {
    int parent = kBase;       ///< Index of a node with a smaller number, or kBase.
    int last_descendant = 0;  ///< The subtree is [own index, last_descendant].
    int depth = 0;            ///< Nodes above this one.
    bool slides = false;      ///< A slide joint; else a hinge.
    int joint = 0;            ///< Index into Robot::joints().
    int qpos_address = 0;
    double reference = 0.0;  ///< Joint position at which the node stands at parent_from_node.
    Pose parent_from_node;   ///< Constant; metres.
  };

  /// Where a body hangs: a node, kBase or kWorld, and its constant pose there.
  struct Attachment {
    int node = kWorld;
    Pose node_from_body;
  };

  /// @param bodies  bodies of interest, by Robot's index.
  MovingTree(const Robot& robot, std::span<const int> bodies);

  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  [[nodiscard]] int dof_count() const { return kBaseDofs + static_cast<int>(nodes_.size()); }
  /// In the order of the bodies given.
  [[nodiscard]] const std::vector<Attachment>& attachments() const { return attachments_; }

 private:
  std::vector<Node> nodes_;
  std::vector<Attachment> attachments_;
};

/// Poses of a MovingTree's nodes in one configuration.
struct TreeState {
  explicit TreeState(const MovingTree& tree)
      : world_from_node(tree.nodes().size()), axis(tree.nodes().size()) {}

  Pose world_from_base;
  std::vector<Pose> world_from_node;
  std::vector<Eigen::Vector3d> axis;  ///< Of each joint, in the world.

  /// @param qpos  in the layout of Robot.
  void update(const MovingTree& tree, std::span<const double> qpos);

  [[nodiscard]] Pose world_from_body(const MovingTree::Attachment& attachment) const;
};

}  // namespace retarget
