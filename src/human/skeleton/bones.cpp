#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/appearance.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"

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

namespace {

using enum LimbBone;

Eigen::Matrix3d columns(const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                        const Eigen::Vector3d& z) {
  Eigen::Matrix3d axes;
  axes << x, y, z;
  return axes;
}

// The foot slopes down by 25 degrees from the ankle to the ball.
constexpr double kSineOfPitch = 0.42261826174069944;
constexpr double kCosineOfPitch = 0.90630778703664996;

}  // namespace

Eigen::Matrix3d canonical_t_pose(Bone bone) {
  const Eigen::Vector3d forward = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const std::optional<LimbBone> part = limb_bone(bone);
  if (!part) return columns(up, forward, left);
  switch (*part) {
    case kUpLeg:
    case kLeg:
      return columns(-up, forward, -left);
    case kToe:
    case kFootMod:
      return columns(forward, up, -left);
    case kFoot:
      return columns(kCosineOfPitch * forward - kSineOfPitch * up,
                     kSineOfPitch * forward + kCosineOfPitch * up, -left);
    default:
      return side_of(bone) == Side::kLeft ? columns(left, -forward, up)
                                          : columns(-left, -forward, -up);
  }
}

int side_colour(Side side) {
  constexpr std::array kColours = {0x8A8A8A, 0x5AA469, 0xD0705F};
  return kColours[static_cast<std::size_t>(side)];
}

std::vector<int> joint_colours(const Skeleton& skeleton, const Calibration& calibration) {
  std::vector<int> colours(static_cast<std::size_t>(skeleton.joint_count()), -1);
  for (const Bone bone : kMappedBones) {
    const int joint = calibration.bones[bone].position_joint;
    if (joint >= 0) colours[static_cast<std::size_t>(joint)] = side_colour(side_of(bone));
  }
  for (std::size_t j = 0; j < colours.size(); ++j) {
    const int parent = skeleton.joint(static_cast<int>(j)).parent;
    if (colours[j] >= 0) continue;
    colours[j] = parent < 0 ? side_colour(Side::kNone) : colours[static_cast<std::size_t>(parent)];
  }
  return colours;
}

}  // namespace retarget
