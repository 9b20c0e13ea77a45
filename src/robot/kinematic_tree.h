#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "retarget/pose.h"
#include "retarget/robot.h"

namespace retarget {

/// A robot's kinematic tree with everything that does not move folded away. Link 0 is the body of
/// the free joint, the base; every other link is what one joint moves, its origin at the joint's
/// anchor, its z axis along the joint's axis.
///
/// Degrees of freedom are numbered anew: 0-2 the base's position in the world, 3-5 its rotation in
/// its own axes, then one per link, parents first and each subtree without gaps.
class KinematicTree {
 public:
  static constexpr int kBaseDofs = 6;
  static constexpr int kWorld = -1;  ///< Stands for the link of bodies that do not move at all.

  struct Link {
    int parent = kWorld;      ///< A link with a smaller number; of the base kWorld.
    int last_descendant = 0;  ///< The subtree is [own index, last_descendant].
    int body = 0;             ///< The robot's body that the joint moves.
    int joint = -1;           ///< Index into Robot::joints(); of the base -1.
    bool slides = false;      ///< A slide joint; else a hinge.
    int qpos_address = 0;
    double reference = 0.0;  ///< Joint position at which the link stands at parent_from_link.
    Pose parent_from_link;   ///< Constant; metres.
  };

  /// Where a body hangs: its link, and its constant pose there.
  struct Attachment {
    int link = kWorld;
    Pose link_from_body;
  };

  KinematicTree() = default;
  /// The tree of all joints, in Robot's order: link 1 is what joint 0 moves.
  explicit KinematicTree(const Robot& robot);
  /// Without the joints that carry none of these bodies, given by Robot's index.
  KinematicTree(const Robot& robot, std::span<const int> bodies);

  [[nodiscard]] const std::vector<Link>& links() const { return links_; }
  /// Of one of the bodies that the tree was made for.
  [[nodiscard]] const Attachment& attachment(int body) const { return attachments_[body]; }
  /// By Robot's index of a joint; kWorld: it was left out.
  [[nodiscard]] int link_of_joint(int joint) const { return link_of_joint_[joint]; }
  /// Whether a link is another one or carries it; kWorld is carried by none.
  [[nodiscard]] bool carries(int link, int other) const {
    return other >= link && other <= links_[link].last_descendant;
  }
  /// Links whose joints hang directly on this one.
  [[nodiscard]] std::vector<int> children(int link) const;

  /// The body of the link that carries this one; itself for bodies that a joint moves, 0 for those
  /// that nothing moves.
  [[nodiscard]] int carrier(int body) const;
  /// All bodies that move with this one, which a joint moves; itself first.
  [[nodiscard]] std::vector<int> rigid_group(int body) const;

  [[nodiscard]] int dof_count() const { return kBaseDofs - 1 + static_cast<int>(links_.size()); }
  /// The last degree of freedom that moves a link; of the base its last one.
  [[nodiscard]] static constexpr int dof_of(int link) { return kBaseDofs - 1 + link; }
  /// The degrees of freedom that carry this one, from the base down to itself.
  [[nodiscard]] std::span<const int> carriers(int dof) const {
    return std::span(carriers_).subspan(row_begin_[dof], row_begin_[dof + 1] - row_begin_[dof]);
  }
  /// Symmetric matrices with the sparsity of the tree are kept as rows over carriers(dof), one
  /// after the other: where each begins, and behind the last how many entries there are.
  [[nodiscard]] const std::vector<int>& row_begin() const { return row_begin_; }

 private:
  void number_dofs();

  std::vector<Link> links_;
  std::vector<Attachment> attachments_;  // by body
  std::vector<int> link_of_joint_;
  std::vector<int> carriers_, row_begin_;
};

/// Poses of a tree's links and motion subspaces of its degrees of freedom in one configuration.
/// The tree must stay where it is. Nothing is allocated in update.
struct TreeState {
  explicit TreeState(const KinematicTree& of);
  TreeState(const KinematicTree& of, std::span<const double> qpos) : TreeState(of) { update(qpos); }

  /// @param qpos  in the layout of Robot; the root quaternion need not be a unit one.
  void update(std::span<const double> qpos);
  /// The same where nothing but a link, which is not the base, and what it carries has moved since
  /// the last update.
  void update_subtree(int link, std::span<const double> qpos);

  [[nodiscard]] const Eigen::Vector3d& origin() const { return world_from_link[0].translation; }
  [[nodiscard]] Pose world_from_body(int body) const;
  /// Of a joint by Robot's index, in the world.
  [[nodiscard]] const Eigen::Vector3d& anchor(int joint) const;
  [[nodiscard]] const Eigen::Vector3d& axis(int joint) const;
  [[nodiscard]] bool slides(int joint) const {
    return tree->links()[tree->link_of_joint(joint)].slides;
  }
  /// Velocity of a point of what a degree of freedom carries, per unit of it.
  [[nodiscard]] Eigen::Vector3d velocity_at(int dof, const Eigen::Vector3d& point) const {
    return linear[dof] + angular[dof].cross(point - origin());
  }

  const KinematicTree* tree;
  std::vector<Pose> world_from_link;
  /// Motion subspaces: velocity of the point of the carried body that is at the base's origin, and
  /// angular velocity, per unit of each degree of freedom, in the world.
  std::vector<Eigen::Vector3d> linear, angular;

 private:
  void place_links(int first, int last, std::span<const double> qpos);
};

/// Where the axes of joints come nearest to each other (least squares, drawn slightly towards the
/// anchors where axes are parallel); a slide counts with its anchor alone.
/// @param joints  at least one, by Robot's index.
[[nodiscard]] Eigen::Vector3d common_point(const TreeState& state, std::span<const int> joints);

}  // namespace retarget
