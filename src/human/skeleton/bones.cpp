#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/human.h"

namespace retarget {
namespace {

constexpr std::array<std::string_view, kBoneCount> kNames = {
    "Hips",          "LeftUpLeg", "LeftLeg",      "LeftFoot",  "LeftToe",     "RightUpLeg",
    "RightLeg",      "RightFoot", "RightToe",     "Spine",     "Spine1",      "Spine2",
    "Neck",          "Head",      "LeftShoulder", "LeftArm",   "LeftForeArm", "LeftHand",
    "RightShoulder", "RightArm",  "RightForeArm", "RightHand", "LeftFootMod", "RightFootMod"};

struct LimbPlace {
  Side side = Side::kNone;
  std::optional<LimbBone> part;
};

LimbPlace place_in_limb(Bone bone) {
  for (const Side side : kSides) {
    for (auto part = LimbBone::kUpLeg; part <= LimbBone::kFootMod;
         part = static_cast<LimbBone>(static_cast<int>(part) + 1)) {
      if (side_bone(side, part) == bone) return {side, part};
    }
  }
  return {};
}

}  // namespace

std::string_view bone_name(Bone bone) {
  return kNames[static_cast<std::size_t>(bone)];
}

std::optional<Bone> bone_from_name(std::string_view name) {
  if (name == "LeftToeBase") return Bone::kLeftToe;
  if (name == "RightToeBase") return Bone::kRightToe;
  const auto found = std::ranges::find(kNames, name);
  if (found == kNames.end()) return std::nullopt;
  return kAllBones[static_cast<std::size_t>(found - kNames.begin())];
}

std::string_view finger_name(Finger finger) {
  constexpr std::array<std::string_view, kFingerCount> kFingerNames = {"thumb", "index", "middle",
                                                                       "ring", "little"};
  return kFingerNames[static_cast<std::size_t>(finger)];
}

const std::vector<std::string>& bone_names() {
  static const std::vector<std::string> kAll(kNames.begin(), kNames.end());
  return kAll;
}

const std::vector<std::string>& mapped_bone_names() {
  static const std::vector<std::string> kMapped(kNames.begin(), kNames.begin() + kMappedBoneCount);
  return kMapped;
}

Side side_of(Bone bone) {
  return place_in_limb(bone).side;
}

std::optional<LimbBone> limb_bone(Bone bone) {
  return place_in_limb(bone).part;
}

bool BoneMap::maps(int joint) const {
  return std::ranges::find(joint_of_bone, joint) != joint_of_bone.end();
}

int BoneMap::mapped_count() const {
  return static_cast<int>(
      std::ranges::count_if(joint_of_bone, [](int joint) { return joint >= 0; }));
}

Bone mirrored(Bone bone) {
  const auto [side, part] = place_in_limb(bone);
  return part ? side_bone(side == Side::kLeft ? Side::kRight : Side::kLeft, *part) : bone;
}

}  // namespace retarget
