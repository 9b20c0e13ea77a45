#include "human/skeleton/skeleton_tree.h"

#include <algorithm>

namespace retarget {

SkeletonTree::SkeletonTree(const Skeleton& skeleton)
    : parents_(skeleton.joint_count()),
      depths_(skeleton.joint_count()),
      neighbours_(skeleton.joint_count()) {
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    const int parent = skeleton.joint(joint).parent;
    parents_[joint] = parent;
    if (parent < 0) continue;
    depths_[joint] = depths_[parent] + 1;
    neighbours_[parent].push_back(joint);
    neighbours_[joint].push_back(parent);
  }
}

int SkeletonTree::common_ancestor(int a, int b) const {
  while (a != b) {
    int& deeper = depths_[a] >= depths_[b] ? a : b;
    deeper = parents_[deeper];
  }
  return a;
}

std::vector<int> SkeletonTree::path(int a, int b) const {
  const int top = common_ancestor(a, b);
  std::vector<int> joints, way_down;
  for (; a != top; a = parents_[a]) joints.push_back(a);
  joints.push_back(top);
  for (; b != top; b = parents_[b]) way_down.push_back(b);
  joints.insert(joints.end(), way_down.rbegin(), way_down.rend());
  return joints;
}

std::vector<int> SkeletonTree::chain(int before, int joint) const {
  std::vector<int> joints = {joint};
  while (neighbours_[joint].size() == 2) {
    const std::vector<int>& both = neighbours_[joint];
    const int next = both[0] == before ? both[1] : both[0];
    before = joint;
    joint = next;
    joints.push_back(joint);
  }
  return joints;
}

bool SkeletonTree::between(int joint, int a, int b) const {
  return meeting_point(joint, a, b) == joint;
}

int SkeletonTree::meeting_point(int a, int b, int c) const {
  const int ab = common_ancestor(a, b), bc = common_ancestor(b, c), ac = common_ancestor(a, c);
  // Two of the three are the same joint, and the third one lies below it.
  return std::max({ab, bc, ac}, [&](int x, int y) { return depths_[x] < depths_[y]; });
}

const std::vector<std::vector<Bone>>& bone_chains() {
  static const std::vector<std::vector<Bone>> kChains = {
      {Bone::kHips, Bone::kLeftUpLeg, Bone::kLeftLeg, Bone::kLeftFoot, Bone::kLeftToe},
      {Bone::kHips, Bone::kRightUpLeg, Bone::kRightLeg, Bone::kRightFoot, Bone::kRightToe},
      {Bone::kHips, Bone::kSpine, Bone::kSpine1, Bone::kSpine2, Bone::kNeck, Bone::kHead},
      {Bone::kHips, Bone::kSpine, Bone::kSpine1, Bone::kSpine2, Bone::kLeftShoulder, Bone::kLeftArm,
       Bone::kLeftForeArm, Bone::kLeftHand},
      {Bone::kHips, Bone::kSpine, Bone::kSpine1, Bone::kSpine2, Bone::kRightShoulder,
       Bone::kRightArm, Bone::kRightForeArm, Bone::kRightHand}};
  return kChains;
}

const std::vector<Bone>& trunk_bones() {
  return bone_chains()[2];
}

std::vector<Bone> bones_out_of_line(const SkeletonTree& tree, const BoneMap& map,
                                    const std::vector<Bone>& chain) {
  std::vector<Bone> stray;
  std::vector<int> joints;
  for (const Bone bone : chain) {
    const int joint = map.joint(bone);
    if (joint < 0) continue;
    const std::size_t count = joints.size();
    const bool fits =
        count == 0 || (joint != joints.back() &&
                       (count == 1 || tree.between(joints[count - 1], joints[count - 2], joint)));
    if (fits) {
      joints.push_back(joint);
    } else {
      stray.push_back(bone);
    }
  }
  return stray;
}

}  // namespace retarget
