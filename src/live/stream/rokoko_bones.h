#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <string_view>

#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// A bone of Rokoko Studio's streams, with its name in JSON.
struct RokokoBone {
  std::string_view name;
  int parent;      ///< Index into kRokokoBones; -1: none.
  Bone bone;       ///< Canonical bone; for toe ends, the toe.
  bool is_needed;  ///< A body must have it.
  bool is_end;     ///< An end without a bone of its own.
  /// Rotation in a T-pose that faces z, in Unity's left-handed world: x y z w. All bones extend
  /// along their -y axis.
  std::array<double, 4> unity_t_pose;
};

inline constexpr double kRokokoHalfTurn = 0.70710678118654752;  // sin(pi / 4)

// Names, T-pose and world follow Rokoko's own plugins (rokoko-studio-live-unity's
// JsonLiveSerializerV3 and Actor, rokoko-studio-live-blender's animation_lists). In that T-pose the
// left arm points to -x and the toes to z, so the world is left-handed.
namespace rokoko_t_pose {
inline constexpr double kS = kRokokoHalfTurn;
inline constexpr std::array<double, 4> kHip = {0, 0, 0, 1}, kTrunk = {0, 0, 1, 0},
                                       kLeftShoulder = {0, 0, kS, -kS},
                                       kRightShoulder = {0, 0, kS, kS},
                                       kLeftArm = {-0.5, -0.5, 0.5, -0.5},
                                       kRightArm = {0.5, -0.5, 0.5, 0.5}, kLeftLeg = {0, kS, 0, kS},
                                       kRightLeg = {0, -kS, 0, kS}, kLeftFoot = {0, kS, -kS, 0},
                                       kRightFoot = {0, -kS, kS, 0};
}  // namespace rokoko_t_pose

/// Parents precede children; fingers are omitted because they move no robot.
inline constexpr auto kRokokoBones = std::to_array<RokokoBone>({
    {"hip", -1, Bone::kHips, true, false, rokoko_t_pose::kHip},
    {"spine", 0, Bone::kSpine, true, false, rokoko_t_pose::kTrunk},
    {"chest", 1, Bone::kSpine2, true, false, rokoko_t_pose::kTrunk},
    {"neck", 2, Bone::kNeck, false, false, rokoko_t_pose::kTrunk},
    {"head", 3, Bone::kHead, false, false, rokoko_t_pose::kTrunk},
    {"leftShoulder", 2, Bone::kLeftShoulder, false, false, rokoko_t_pose::kLeftShoulder},
    {"leftUpperArm", 5, Bone::kLeftArm, true, false, rokoko_t_pose::kLeftArm},
    {"leftLowerArm", 6, Bone::kLeftForeArm, true, false, rokoko_t_pose::kLeftArm},
    {"leftHand", 7, Bone::kLeftHand, true, false, rokoko_t_pose::kLeftArm},
    {"rightShoulder", 2, Bone::kRightShoulder, false, false, rokoko_t_pose::kRightShoulder},
    {"rightUpperArm", 9, Bone::kRightArm, true, false, rokoko_t_pose::kRightArm},
    {"rightLowerArm", 10, Bone::kRightForeArm, true, false, rokoko_t_pose::kRightArm},
    {"rightHand", 11, Bone::kRightHand, true, false, rokoko_t_pose::kRightArm},
    {"leftUpLeg", 0, Bone::kLeftUpLeg, true, false, rokoko_t_pose::kLeftLeg},
    {"leftLeg", 13, Bone::kLeftLeg, true, false, rokoko_t_pose::kLeftLeg},
    {"leftFoot", 14, Bone::kLeftFoot, true, false, rokoko_t_pose::kLeftFoot},
    {"leftToe", 15, Bone::kLeftToe, false, false, rokoko_t_pose::kLeftFoot},
    {"leftToeEnd", 16, Bone::kLeftToe, false, true, rokoko_t_pose::kLeftFoot},
    {"rightUpLeg", 0, Bone::kRightUpLeg, true, false, rokoko_t_pose::kRightLeg},
    {"rightLeg", 18, Bone::kRightLeg, true, false, rokoko_t_pose::kRightLeg},
    {"rightFoot", 19, Bone::kRightFoot, true, false, rokoko_t_pose::kRightFoot},
    {"rightToe", 20, Bone::kRightToe, false, false, rokoko_t_pose::kRightFoot},
    {"rightToeEnd", 21, Bone::kRightToe, false, true, rokoko_t_pose::kRightFoot},
});
inline constexpr std::size_t kRokokoBoneCount = kRokokoBones.size();

/// The T-pose rotation in Unity's coordinates.
[[nodiscard]] inline Eigen::Quaterniond rokoko_t_pose_of(const RokokoBone& bone) {
  const auto& [x, y, z, w] = bone.unity_t_pose;
  return {w, x, y, z};
}

}  // namespace retarget
