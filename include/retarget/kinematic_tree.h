#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "retarget/export.h"
#include "retarget/pose.h"
#include "retarget/robot.h"

namespace RETARGET_API retarget {

/// A robot's kinematic tree with fixed joints folded into their parents. Link 0, the base, is the
/// body of the free joint. Every other link is moved by one joint: its origin is the joint's
/// anchor, its z axis the joint's axis.
///
/// Degrees of freedom have their own numbering: 0-2 are the base's position in the world, 3-5 its
/// rotation in its own axes; then one per link, parents first, with each subtree contiguous.
class KinematicTree {
 public:
  static constexpr int kBaseDofs = 6;
  static constexpr int kWorld = -1;  ///< Link of bodies that do not move.

  struct Link {
    int parent = kWorld;      ///< Always a smaller index; kWorld for the base.
    int last_descendant = 0;  ///< The subtree is [own index, last_descendant].
    int body = 0;             ///< Index of the body that the joint moves.
    int joint = -1;           ///< Index into Robot::joints(); -1 for the base.
    bool slides = false;      ///< True for a slide joint, false for a hinge.
    int qpos_address = 0;
    double reference = 0.0;  ///< Joint position at which the link's pose is parent_from_link.
    Pose parent_from_link;   ///< Constant; in metres.
  };

  /// The link that a body is attached to and its constant pose in that link.
  struct Attachment {
    int link = kWorld;
    Pose link_from_body;
  };

  KinematicTree() = default;
  /// Builds the tree of all joints, in Robot's order: joint 0 moves link 1.
  explicit KinematicTree(const Robot& robot);
  /// Omits joints that carry none of the given bodies (Robot's body indices).
  KinematicTree(const Robot& robot, std::span<const int> bodies);

  [[nodiscard]] const std::vector<Link>& links() const { return links_; }
  /// Returns the attachment of one of the bodies that the tree was built for.
  [[nodiscard]] const Attachment& attachment(int body) const { return attachments_[body]; }
  /// Returns the link of a joint, by Robot's joint index; kWorld if the tree omits the joint.
  [[nodiscard]] int link_of_joint(int joint) const { return link_of_joint_[joint]; }
  /// Returns true if `link` carries `other` or is the same link. No link carries kWorld.
  [[nodiscard]] bool carries(int link, int other) const {
    return other >= link && other <= links_[link].last_descendant;
  }
  /// Returns the child links of this link.
  [[nodiscard]] std::vector<int> children(int link) const;

  /// Returns the moved body whose link carries this body: the body itself if a joint moves it, 0 if
  /// no joint does.
  [[nodiscard]] int carrier(int body) const;
  /// Returns all bodies that move rigidly with this one, which a joint must move; itself first.
  [[nodiscard]] std::vector<int> rigid_group(int body) const;

  [[nodiscard]] int dof_count() const { return kBaseDofs - 1 + static_cast<int>(links_.size()); }
  /// Returns the degree of freedom of a link's joint; for the base, its last one.
  [[nodiscard]] static constexpr int dof_of(int link) { return kBaseDofs - 1 + link; }
  /// Returns the degrees of freedom that carry this one, from the base down to itself.
  [[nodiscard]] std::span<const int> carriers(int dof) const {
    return std::span(carriers_).subspan(row_begin_[dof], row_begin_[dof + 1] - row_begin_[dof]);
  }
  /// Symmetric matrices with the sparsity of the tree are stored as consecutive rows over
  /// carriers(dof). Entry `dof` is the offset of that row; the last entry is the total number of
  /// values.
  [[nodiscard]] const std::vector<int>& row_begin() const { return row_begin_; }

 private:
  void number_dofs();

  std::vector<Link> links_;
  std::vector<Attachment> attachments_;  // Indexed by body.
  std::vector<int> link_of_joint_;
  std::vector<int> carriers_, row_begin_;
};

/// Link poses and motion subspaces of a tree in one configuration. Keeps a pointer to the tree,
/// which must outlive it and must not move. `update` does not allocate.
struct TreeState {
  explicit TreeState(const KinematicTree& of);
  TreeState(const KinematicTree& of, std::span<const double> qpos) : TreeState(of) { update(qpos); }

  /// @param qpos  configuration in Robot's layout; the root quaternion need not be normalised.
  void update(std::span<const double> qpos);
  /// Updates only the subtree of a link other than the base; nothing else may have moved since the
  /// last update.
  void update_subtree(int link, std::span<const double> qpos);
  /// Updates only the links up to `last`, and those that carry them.
  void update_up_to(int last, std::span<const double> qpos);

  [[nodiscard]] const Eigen::Vector3d& origin() const { return world_from_link[0].translation; }
  [[nodiscard]] Pose world_from_body(int body) const;
  /// Returns the world-frame anchor of a joint, by Robot's joint index.
  [[nodiscard]] const Eigen::Vector3d& anchor(int joint) const;
  [[nodiscard]] const Eigen::Vector3d& axis(int joint) const;
  [[nodiscard]] bool slides(int joint) const {
    return tree->links()[tree->link_of_joint(joint)].slides;
  }
  /// Returns the velocity of a carried point per unit velocity of a degree of freedom.
  [[nodiscard]] Eigen::Vector3d velocity_at(int dof, const Eigen::Vector3d& point) const {
    return linear[dof] + angular[dof].cross(point - origin());
  }

  const KinematicTree* tree;
  std::vector<Pose> world_from_link;
  /// Motion subspaces per degree of freedom, in world axes: linear velocity of the carried point at
  /// the base's origin, and angular velocity.
  std::vector<Eigen::Vector3d> linear, angular;

 private:
  void place_links(int first, int last, std::span<const double> qpos);

  std::vector<double> half_travel_, sine_, cosine_;  // Scratch memory, by joint.
};

/// Computes the least-squares intersection of joint axes, slightly regularised towards the anchors
/// for parallel axes. A slide joint contributes only its anchor.
/// @param joints  at least one, by Robot's joint index.
[[nodiscard]] Eigen::Vector3d common_point(const TreeState& state, std::span<const int> joints);

}  // namespace retarget
