#pragma once

#include <array>
#include <utility>

#include "retarget/human_skeleton.h"

namespace retarget {

/// Approximate mass fractions around these joints.
inline constexpr std::array<std::pair<Bone, double>, 11> kBodyMasses = {
    {{Bone::kHips, 0.25},
     {Bone::kSpine2, 0.30},
     {Bone::kHead, 0.08},
     {Bone::kLeftLeg, 0.11},
     {Bone::kRightLeg, 0.11},
     {Bone::kLeftFoot, 0.04},
     {Bone::kRightFoot, 0.04},
     {Bone::kLeftForeArm, 0.03},
     {Bone::kRightForeArm, 0.03},
     {Bone::kLeftHand, 0.02},
     {Bone::kRightHand, 0.02}}};

}  // namespace retarget
