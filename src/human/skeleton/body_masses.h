#pragma once

#include <Eigen/Core>
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

/// Positions of bones weighted by mass fraction, and the sum of these fractions; their quotient is
/// the centre of mass.
struct WeightedPositions {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double mass = 0.0;
};

/// Sums over the bones that a body has.
/// @param has    whether the body has a bone.
/// @param place  position of such a bone.
template <typename Has, typename Place>
[[nodiscard]] WeightedPositions weighted_positions(const Has& has, const Place& place) {
  WeightedPositions weighted;
  for (const auto& [bone, share] : kBodyMasses) {
    if (!has(bone)) continue;
    weighted.sum += share * place(bone);
    weighted.mass += share;
  }
  return weighted;
}

}  // namespace retarget
