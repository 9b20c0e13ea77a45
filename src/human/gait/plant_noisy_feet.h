#pragma once

#include <Eigen/Core>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Result of plant_noisy_feet().
struct NoisyFeet {
  int stances = 0;        ///< Number of stances of feet.
  double farthest = 0.0;  ///< Largest displacement of an ankle relative to the hips, metres.
};

/// Holds feet that probably stand at the median positions of their stances (noisy_stances.h). Root
/// drift alone cannot do that: with noise in the joints of the legs two standing feet move
/// relative to each other. The root follows the common, slow part of the corrections; the legs
/// take the remainder by two-bone inverse kinematics. Between stances the corrections change
/// smoothly.
/// @param moved        body_joint()
/// @param noise_speed  median speed of standing feet, m/s for a body with legs of kUsualSourceLeg
NoisyFeet plant_noisy_feet(Clip& clip, FrameRange part, const Calibration& calibration, int moved,
                           double noise_speed);

/// The joint that moves the whole body: the topmost one from the hips upwards that has a position;
/// -1: none.
[[nodiscard]] int body_joint(const Skeleton& skeleton, const Calibration& calibration);

/// Translates the whole body.
/// @param joint  body_joint()
/// @param shift  world, metres
void move_body(Clip& clip, int frame, const Calibration& calibration, int joint,
               const Eigen::Vector3d& shift);

}  // namespace retarget
