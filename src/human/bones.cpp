#include "human/bones.h"

#include <algorithm>

namespace retarget {

std::optional<int> find_bone(std::string_view name) {
  if (name == "LeftToeBase") name = "LeftToe";
  if (name == "RightToeBase") name = "RightToe";
  const auto found = std::ranges::find(kBoneNames, name);
  if (found == kBoneNames.end()) return std::nullopt;
  return static_cast<int>(found - kBoneNames.begin());
}

const std::vector<std::string>& bone_names() {
  static const std::vector<std::string> kNames(kBoneNames.begin(), kBoneNames.end());
  return kNames;
}

}  // namespace retarget
