#include "retarget/human/bone_map.h"

#include <algorithm>

#include "human/skeleton_tree.h"

namespace retarget {
namespace {

// of the longest way between joints
constexpr double kNoLength = 1e-4;

double longest_offset(const Skeleton& skeleton) {
  double longest = 0.0;
  for (int joint = 1; joint < skeleton.joint_count(); ++joint) {
    longest = std::max(longest, skeleton.joint(joint).offset.norm());
  }
  return longest;
}

// whether a joint carries anything that has a length
bool has_extent(const Skeleton& skeleton, int joint) {
  const auto& ends = skeleton.joint(joint).end_sites;
  return std::ranges::any_of(ends, [](const Eigen::Vector3d& end) { return end.norm() > 0.0; }) ||
         std::ranges::any_of(skeleton.joints(), [joint](const Joint& child) {
           return child.parent == joint && child.offset.norm() > 0.0;
         });
}

// the helper in a joint's place that turns all that the joint turns of the body; -1: there is none
int helper_below(const BoneMap& map, const Skeleton& skeleton, const SkeletonTree& tree,
                 int joint) {
  const double least = kNoLength * longest_offset(skeleton);
  const auto is_mapped = [&](int other) {
    return std::ranges::find(map.joint_of_bone, other) != map.joint_of_bone.end();
  };
  const auto is_below = [&](int other, int upper) {
    return other != upper && tree.between(upper, 0, other);
  };
  int children = 0, helper = -1;
  for (int child = joint + 1; child < skeleton.joint_count(); ++child) {
    const Joint& candidate = skeleton.joint(child);
    if (candidate.parent != joint) continue;
    ++children;
    if (candidate.offset.norm() > least || candidate.has_position_channels() || is_mapped(child)) {
      continue;
    }
    int beyond = 0, beside = 0;
    for (const int mapped : map.joint_of_bone) {
      if (mapped < 0 || !is_below(mapped, joint)) continue;
      ++(is_below(mapped, child) ? beyond : beside);
    }
    const bool is_last = beyond == 0 && has_extent(skeleton, child);
    if (beside == 0 && (beyond > 0 || is_last)) helper = child;
  }
  // what a bone at the end of a limb carries hangs from one joint alone
  const bool carries_bones = helper >= 0 && std::ranges::any_of(map.joint_of_bone, [&](int mapped) {
                               return mapped >= 0 && is_below(mapped, helper);
                             });
  if (!carries_bones && (children > 1 || !skeleton.joint(joint).end_sites.empty())) return -1;
  return helper;
}

}  // namespace

int rotation_joint(const BoneMap& map, const Skeleton& skeleton, std::string_view bone) {
  int joint = map.joint(bone);
  const int hips = map.joint("Hips");
  if (joint < 0 || hips < 0) return joint;
  const SkeletonTree tree(skeleton);
  // joints above the hips carry the part of the body that lies nearer to the hips
  if (joint != hips && tree.between(joint, 0, hips)) {
    const int parent = tree.parent(joint);
    return parent >= 0 ? parent : joint;
  }
  for (int helper = joint; helper >= 0; helper = helper_below(map, skeleton, tree, joint)) {
    joint = helper;
  }
  return joint;
}

}  // namespace retarget
