#pragma once

#include <vector>

#include "human/source_hands.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/motion.h"

namespace retarget {

/// How a robot's fingers follow the human's.
struct HandErrors {
  /// Angles of the fingers' parts from the human's at the same shares of their lengths, both seen from
  /// their palms, radians: all parts, fingers and frames. Thumbs, which stand elsewhere, are left out.
  std::vector<double> angles;
  /// Distances of the robot's thumb and finger, skin to skin, metres, in frames in which the human's
  /// touch; amounts, whichever side of 0.
  std::vector<double> touching_gaps;
};

/// Empty for robots without hands, and sources without fingers that move.
/// @param source  whose frames are the motion's, as far as it goes.
[[nodiscard]] HandErrors measure_hands(const Clip& source, const BoneMap& map,
                                       const RobotClip& motion);

}  // namespace retarget
