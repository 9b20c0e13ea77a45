#pragma once

#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// A skeleton's joints as a tree without a direction: what matters is which joints lie between
/// which, wherever the file has its root.
class SkeletonTree {
 public:
  explicit SkeletonTree(const Skeleton& skeleton);

  [[nodiscard]] int joint_count() const { return static_cast<int>(parents_.size()); }
  [[nodiscard]] int parent(int joint) const { return parents_[joint]; }
  [[nodiscard]] int depth(int joint) const { return depths_[joint]; }
  /// Parent and children.
  [[nodiscard]] const std::vector<int>& neighbours(int joint) const { return neighbours_[joint]; }

  /// Joints from a to b, both included.
  [[nodiscard]] std::vector<int> path(int a, int b) const;
  /// Whether `joint` lies on the path from a to b; its ends count.
  [[nodiscard]] bool between(int joint, int a, int b) const;
  /// The one joint on all three paths between three joints.
  [[nodiscard]] int meeting_point(int a, int b, int c) const;

 private:
  [[nodiscard]] int common_ancestor(int a, int b) const;

  std::vector<int> parents_;
  std::vector<int> depths_;
  std::vector<std::vector<int>> neighbours_;
};

}  // namespace retarget
