#include "human/canonical_tree.h"

#include <algorithm>
#include <set>

namespace retarget {

const std::vector<std::vector<std::string_view>>& bone_chains() {
  static const std::vector<std::vector<std::string_view>> kChains = {
      {"Hips", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToe"},
      {"Hips", "RightUpLeg", "RightLeg", "RightFoot", "RightToe"},
      {"Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"},
      {"Hips", "Spine", "Spine1", "Spine2", "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"},
      {"Hips", "Spine", "Spine1", "Spine2", "RightShoulder", "RightArm", "RightForeArm",
       "RightHand"}};
  return kChains;
}

std::vector<std::string_view> bones_out_of_line(const SkeletonTree& tree, const BoneMap& map,
                                                const std::vector<std::string_view>& chain) {
  std::vector<std::string_view> stray;
  std::vector<int> joints;
  for (const std::string_view bone : chain) {
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

double share_in_line(const SkeletonTree& tree, const BoneMap& map) {
  std::set<std::string_view> stray;
  for (const auto& chain : bone_chains()) {
    for (const std::string_view bone : bones_out_of_line(tree, map, chain)) stray.insert(bone);
  }
  const auto mapped = std::ranges::count_if(map.joint_of_bone, [](int j) { return j >= 0; });
  return mapped == 0 ? 0.0 : 1.0 - static_cast<double>(stray.size()) / static_cast<double>(mapped);
}

}  // namespace retarget
