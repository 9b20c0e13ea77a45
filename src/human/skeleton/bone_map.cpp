#include "retarget/human_skeleton.h"

#include <algorithm>
#include <vector>

namespace retarget {
namespace {

// As a share of the longest joint offset.
constexpr double kNegligible = 1e-4;

// Follows chains of helper joints. The constructor computes the data of all joints once, so a chain
// costs one step per joint.
class HelperChain {
 public:
  HelperChain(const BoneMap& map, const Skeleton& skeleton)
      : skeleton_(skeleton),
        children_(static_cast<std::size_t>(skeleton.joint_count())),
        carried_(children_.size()),
        bones_at_(children_.size()),
        has_extent_(children_.size()) {
    for (const int joint : map.joint_of_bone) {
      if (joint < 0) continue;
      ++bones_at_[joint];
      ++carried_[joint];
    }
    double longest = 0.0;
    // Parents precede their children, so the reverse order visits children first.
    for (int joint = skeleton.joint_count() - 1; joint >= 0; --joint) {
      const Joint& of = skeleton.joint(joint);
      if (std::ranges::any_of(of.end_sites, has_length)) has_extent_[joint] = true;
      if (of.parent < 0) continue;
      carried_[of.parent] += carried_[joint];
      children_[of.parent].push_back(joint);
      longest = std::max(longest, of.offset.norm());
      if (has_length(of.offset)) has_extent_[of.parent] = true;
    }
    min_extent_ = kNegligible * longest;
  }

  // Returns the last helper at the joint's position that rotates everything the joint rotates.
  int last_below(int joint) const {
    for (int helper = joint; helper >= 0; helper = next_below(joint)) joint = helper;
    return joint;
  }

 private:
  static bool has_length(const Eigen::Vector3d& offset) { return offset.norm() > 0.0; }

  // Returns -1 if there is none.
  int next_below(int joint) const {
    const std::vector<int>& children = children_[joint];
    const auto found = std::ranges::find_if(
        children, [&](int child) { return stands_for(child, joint); });  // The last match.
    if (found == children.end()) return -1;
    // At the end of a limb, the child replaces the joint only if the joint has no other child and
    // no end site.
    const bool is_alone = children.size() == 1 && skeleton_.joint(joint).end_sites.empty();
    return carried_[*found] > 0 || is_alone ? *found : -1;
  }

  // Returns whether a child at the joint's position rotates all bones below the joint.
  bool stands_for(int child, int joint) const {
    const Joint& candidate = skeleton_.joint(child);
    if (candidate.offset.norm() > min_extent_ || candidate.has_position_channels() ||
        bones_at_[child] > 0) {
      return false;
    }
    const int below = carried_[joint] - bones_at_[joint];
    return carried_[child] == below && (below > 0 || has_extent_[child]);
  }

  const Skeleton& skeleton_;
  std::vector<std::vector<int>> children_;  // In reverse file order.
  std::vector<int> carried_;                // Number of bones at and below a joint.
  std::vector<int> bones_at_;
  std::vector<bool> has_extent_;  // Whether a child offset or end site has a length.
  double min_extent_ = 0.0;
};

}  // namespace

bool is_above(const Skeleton& skeleton, int upper, int joint) {
  while (joint >= 0 && joint != upper) joint = skeleton.joint(joint).parent;
  return joint == upper;
}

Eigen::Vector3d farthest_end(const Joint& joint) {
  Eigen::Vector3d farthest = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& end : joint.end_sites) {
    if (end.norm() > farthest.norm()) farthest = end;
  }
  return farthest;
}

int rotation_joint(const BoneMap& map, const Skeleton& skeleton, Bone bone) {
  const int joint = map.joint(bone);
  const int hips = map.joint(Bone::kHips);
  if (joint < 0 || hips < 0) return joint;
  // A joint above the hips rotates the part of the body on its hip side.
  if (joint != hips && is_above(skeleton, joint, hips)) {
    const int parent = skeleton.joint(joint).parent;
    return parent >= 0 ? parent : joint;
  }
  return HelperChain(map, skeleton).last_below(joint);
}

}  // namespace retarget
