#pragma once

#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human_skeleton.h"
#include "support/lafan1_map.h"

namespace retarget {

/// A bone map from joint names in the order of the bones; `-` for a missing bone.
inline BoneMap bone_map(const Skeleton& skeleton, const std::vector<std::string>& names,
                        const std::string& profile = "test") {
  BoneMap map;
  map.profile = profile;
  map.confidence = 1.0;
  for (std::size_t bone = 0; bone < names.size(); ++bone) {
    map.joint_of_bone[kAllBones[bone]] = skeleton.find(names[bone]).value_or(-1);
  }
  return map;
}

/// Names of both sides from patterns in which `#` stands for the side: thigh, shin, foot, toe,
/// then the trunk Hips, Spine, Spine1, Spine2, Neck, Head, then collar, arm, forearm, hand.
inline std::vector<std::string> two_sided(const std::vector<std::string>& leg,
                                          const std::vector<std::string>& trunk,
                                          const std::vector<std::string>& arm,
                                          const std::string& left, const std::string& right) {
  const auto sided = [](std::string pattern, const std::string& side) {
    if (const auto at = pattern.find('#'); at != std::string::npos) pattern.replace(at, 1, side);
    return pattern;
  };
  std::vector<std::string> names = {trunk[0]};
  for (const std::string& side : {left, right}) {
    for (const std::string& part : leg) names.push_back(sided(part, side));
  }
  names.insert(names.end(), trunk.begin() + 1, trunk.end());
  for (const std::string& side : {left, right}) {
    for (const std::string& part : arm) names.push_back(sided(part, side));
  }
  return names;
}

}  // namespace retarget
