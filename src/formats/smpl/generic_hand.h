#pragma once

#include <Eigen/Core>
#include <array>

#include "retarget/human.h"

namespace retarget {

/// A finger of average proportions, in metres for a body 1.75 m tall. Palm axes: x along the hand,
/// y to the thumb's side, z out of the palm; the origin is the wrist.
struct GenericFinger {
  Eigen::Vector3d knuckle;        ///< For the thumb: its base at the wrist.
  Eigen::Vector3d direction;      ///< Unit vector along the straight finger.
  std::array<double, 3> bones{};  ///< From the knuckle; the last includes the soft tip.
};

/// A hand of average proportions, indexed by Finger. docs/hands.md has the table and its sources;
/// no data comes from a body model.
[[nodiscard]] const std::array<GenericFinger, kFingerCount>& generic_hand();

}  // namespace retarget
