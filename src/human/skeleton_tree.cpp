#include "human/skeleton_tree.h"

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

bool SkeletonTree::between(int joint, int a, int b) const {
  return meeting_point(joint, a, b) == joint;
}

int SkeletonTree::meeting_point(int a, int b, int c) const {
  const int ab = common_ancestor(a, b), bc = common_ancestor(b, c), ac = common_ancestor(a, c);
  // two of the three are the same joint, the third lies below it
  return std::max({ab, bc, ac}, [&](int x, int y) { return depths_[x] < depths_[y]; });
}

}  // namespace retarget
