#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "retarget/human.h"

namespace retarget {

/// A bone of Unity's HumanBodyBones, as in VRM avatars.
struct UnityBone {
  std::string_view name, parent;
  Bone bone;  ///< Canonical bone.
};

/// Parents precede children; fingers, eyes and jaw are omitted because they move no robot.
inline constexpr auto kUnityBones = std::to_array<UnityBone>({
    {"Hips", "root", Bone::kHips},
    {"Spine", "Hips", Bone::kSpine},
    {"Chest", "Spine", Bone::kSpine1},
    {"UpperChest", "Chest", Bone::kSpine2},
    {"Neck", "UpperChest", Bone::kNeck},
    {"Head", "Neck", Bone::kHead},
    {"LeftShoulder", "UpperChest", Bone::kLeftShoulder},
    {"LeftUpperArm", "LeftShoulder", Bone::kLeftArm},
    {"LeftLowerArm", "LeftUpperArm", Bone::kLeftForeArm},
    {"LeftHand", "LeftLowerArm", Bone::kLeftHand},
    {"RightShoulder", "UpperChest", Bone::kRightShoulder},
    {"RightUpperArm", "RightShoulder", Bone::kRightArm},
    {"RightLowerArm", "RightUpperArm", Bone::kRightForeArm},
    {"RightHand", "RightLowerArm", Bone::kRightHand},
    {"LeftUpperLeg", "Hips", Bone::kLeftUpLeg},
    {"LeftLowerLeg", "LeftUpperLeg", Bone::kLeftLeg},
    {"LeftFoot", "LeftLowerLeg", Bone::kLeftFoot},
    {"LeftToes", "LeftFoot", Bone::kLeftToe},
    {"RightUpperLeg", "Hips", Bone::kRightUpLeg},
    {"RightLowerLeg", "RightUpperLeg", Bone::kRightLeg},
    {"RightFoot", "RightLowerLeg", Bone::kRightFoot},
    {"RightToes", "RightFoot", Bone::kRightToe},
});
inline constexpr std::size_t kUnityBoneCount = kUnityBones.size();

/// Index of a bone in kUnityBones; kUnityBoneCount if the name is unknown.
[[nodiscard]] constexpr std::size_t unity_bone_index(std::string_view name) {
  return static_cast<std::size_t>(std::ranges::find(kUnityBones, name, &UnityBone::name) -
                                  kUnityBones.begin());
}

}  // namespace retarget
