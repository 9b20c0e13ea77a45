#pragma once

#include <Eigen/Core>
#include <array>

#include "retarget/human.h"

namespace retarget {

/// A finger of average proportions in the axes of its palm: along the hand, across to the thumb's side,
/// out of the palm; the wrist is the origin. Metres, of a body 1.75 m high.
struct GenericFinger {
  Eigen::Vector3d knuckle;        ///< Of the thumb its base at the wrist.
  Eigen::Vector3d direction;      ///< Of the straight finger, unit.
  std::array<double, 3> bones{};  ///< Lengths from the knuckle on; the last with the soft tip.
};

/// A hand of average proportions, by Finger (docs/hands.md has the table and its sources); nothing in it
/// comes from a body model.
[[nodiscard]] const std::array<GenericFinger, kFingerCount>& generic_hand();

}  // namespace retarget
