#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "retarget/human.h"

namespace retarget {

/// A joint of the body tracking of PICO headsets, numbered as in OpenXR's XR_BD_body_tracking
/// (XrBodyJointBD) and sent by XRoboToolkit: SMPL's joints, and a hand beyond each wrist.
struct XrobotJoint {
  std::string_view name;
  int parent;           ///< Index into kXrobotJoints; -1: none.
  Bone bone;            ///< Canonical bone; for a hand, that of its wrist.
  bool is_end = false;  ///< An end without a bone of its own.
};

/// In the order of the poses; parents precede children.
inline constexpr auto kXrobotJoints = std::to_array<XrobotJoint>({
    {"Pelvis", -1, Bone::kHips},
    {"Left_Hip", 0, Bone::kLeftUpLeg},
    {"Right_Hip", 0, Bone::kRightUpLeg},
    {"Spine1", 0, Bone::kSpine},
    {"Left_Knee", 1, Bone::kLeftLeg},
    {"Right_Knee", 2, Bone::kRightLeg},
    {"Spine2", 3, Bone::kSpine1},
    {"Left_Ankle", 4, Bone::kLeftFoot},
    {"Right_Ankle", 5, Bone::kRightFoot},
    {"Spine3", 6, Bone::kSpine2},
    {"Left_Foot", 7, Bone::kLeftToe},
    {"Right_Foot", 8, Bone::kRightToe},
    {"Neck", 9, Bone::kNeck},
    {"Left_Collar", 9, Bone::kLeftShoulder},
    {"Right_Collar", 9, Bone::kRightShoulder},
    {"Head", 12, Bone::kHead},
    {"Left_Shoulder", 13, Bone::kLeftArm},
    {"Right_Shoulder", 14, Bone::kRightArm},
    {"Left_Elbow", 16, Bone::kLeftForeArm},
    {"Right_Elbow", 17, Bone::kRightForeArm},
    {"Left_Wrist", 18, Bone::kLeftHand},
    {"Right_Wrist", 19, Bone::kRightHand},
    {"Left_Hand", 20, Bone::kLeftHand, true},
    {"Right_Hand", 21, Bone::kRightHand, true},
});
inline constexpr std::size_t kXrobotJointCount = kXrobotJoints.size();

}  // namespace retarget
