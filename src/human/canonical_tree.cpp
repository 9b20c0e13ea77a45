#include "human/canonical_tree.h"

#include <algorithm>
#include <set>

namespace retarget {

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

double share_in_line(const SkeletonTree& tree, const BoneMap& map) {
  std::set<Bone> stray;
  for (const auto& chain : bone_chains()) {
    for (const Bone bone : bones_out_of_line(tree, map, chain)) stray.insert(bone);
  }
  const auto mapped = std::ranges::count_if(map.joint_of_bone, [](int j) { return j >= 0; });
  return mapped == 0 ? 0.0 : 1.0 - static_cast<double>(stray.size()) / static_cast<double>(mapped);
}

}  // namespace retarget
