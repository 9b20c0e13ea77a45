#pragma once

#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// A skeleton's joints as an undirected tree: relations between joints do not depend on the file's
/// root.
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
  /// Joints in sequence from `joint` on, away from its neighbour `before`, up to a branch or end.
  [[nodiscard]] std::vector<int> chain(int before, int joint) const;
  /// Whether `joint` lies on the path from a to b, ends included.
  [[nodiscard]] bool between(int joint, int a, int b) const;
  /// The one joint on all three paths between three joints.
  [[nodiscard]] int meeting_point(int a, int b, int c) const;

 private:
  [[nodiscard]] int common_ancestor(int a, int b) const;

  std::vector<int> parents_;
  std::vector<int> depths_;
  std::vector<std::vector<int>> neighbours_;
};

/// Bones from the hips outwards, in the order in which they are in line in every skeleton.
[[nodiscard]] const std::vector<std::vector<Bone>>& bone_chains();

/// Bones of the trunk, starting at the hips.
[[nodiscard]] const std::vector<Bone>& trunk_bones();

/// Returns the mapped bones of a chain that are out of line: their joint does not lie beyond the
/// two previously mapped bones. Empty: the chain is in line.
[[nodiscard]] std::vector<Bone> bones_out_of_line(const SkeletonTree& tree, const BoneMap& map,
                                                  const std::vector<Bone>& chain);

}  // namespace retarget
