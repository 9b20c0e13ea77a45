#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "human/gait/source_feet.h"
#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Whether each end of the feet stands on the floor, by frame: left heel, left toe, right heel,
/// right toe.
using NoisyStances = std::array<std::vector<char>, 4>;

/// Index of one end of a foot in NoisyStances.
[[nodiscard]] constexpr std::size_t stance_index(int foot, int end) {
  return static_cast<std::size_t>(2 * foot + end);
}

/// Finds the stances of feet whose positions are noisy. Thresholds on single frames break such
/// stances where the noise peaks; here the most likely sequence of stances and swings of both feet
/// is found. In it a change must be supported by evidence over a tenth of a second, and an upright
/// body is rarely without support.
/// @param noise_speed  median speed of standing feet, m/s for a body with legs of kUsualSourceLeg
[[nodiscard]] NoisyStances find_noisy_stances(const SourceFeet& feet, double noise_speed);

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

/// The joint that moves the whole body: the topmost one from the hips upwards that has a position;
/// -1: none.
[[nodiscard]] int body_joint(const Skeleton& skeleton, const Calibration& calibration);

/// Translates the whole body.
/// @param joint  body_joint()
/// @param shift  world, metres
void move_body(Clip& clip, int frame, const Calibration& calibration, int joint,
               const Eigen::Vector3d& shift);

}  // namespace retarget
