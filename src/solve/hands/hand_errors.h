#pragma once

#include <vector>

#include "human/skeleton/source_hands.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/motion.h"

namespace retarget {

/// Deviation of a robot's fingers from the human's.
struct HandErrors {
  /// Angles between the parts of the robot's fingers and those of the human's at the same shares of
  /// their lengths, both relative to the palm, radians; for all parts, fingers and frames. Excludes
  /// thumbs, which are placed differently.
  std::vector<double> angles;
  /// Absolute distances between the robot's thumb and finger, skin to skin, metres, in frames in
  /// which the human's touch.
  std::vector<double> touching_gaps;
};

/// Returns empty lists for robots without hands, and for sources without moving fingers.
/// @param source  clip whose frames correspond to those of `motion`; the shorter one determines the
///     length.
[[nodiscard]] HandErrors measure_hands(const Clip& source, const BoneMap& map,
                                       const RobotClip& motion);

}  // namespace retarget
