#pragma once

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Result of plant_noisy_feet().
struct NoisyFeet {
  int stances = 0;        ///< Number of stances of feet.
  double farthest = 0.0;  ///< Largest displacement of an ankle relative to the hips, metres.
};

/// Holds feet that probably stand at the median positions of their stances. Root
/// drift alone cannot do that: with noise in the joints of the legs two standing feet move
/// relative to each other. The root follows the common, slow part of the corrections; the legs
/// take the remainder by two-bone inverse kinematics. Between stances the corrections change
/// smoothly.
/// @param moved        body_joint()
/// @param noise_speed  of standing feet, m/s for a body with legs of kUsualSourceLeg
/// @param noise_distance  RMS error of the feet, metres for that body. An end of a foot is held
///     only where it is within three times that of its place: farther away it steps or rolls.
NoisyFeet plant_noisy_feet(Clip& clip, FrameRange part, const Calibration& calibration, int moved,
                           double noise_speed, double noise_distance);

}  // namespace retarget
