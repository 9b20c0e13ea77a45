#pragma once

#include <Eigen/Core>
#include <array>

#include "retarget/human.h"

namespace retarget {

/// Rotations of one arm and one leg of the canonical human away from the T-pose, rad.
struct LimbPosture {
  double arm_down = 0.0;   ///< Applied second: lowers the whole arm from the side; negative raises
                           ///< it.
  double arm_ahead = 0.0;  ///< Applied third, about the vertical: moves the arm from the side to
                           ///< the front.
  double arm_twist = 0.0;  ///< Applied first, about the arm: turns the elbow's bend from forward to
                           ///< upward.
  double elbow = 0.0;      ///< Flexion.
  double thigh_ahead = 0.0;  ///< Raises the thigh from vertical to the front.
  double knee = 0.0;         ///< Flexion.
};

/// Left, right.
using HumanPosture = std::array<LimbPosture, 2>;

/// Returns the canonical human with LAFAN1's bone lengths (HumanLengths), upright and facing along
/// x, with level feet and the lower ankle at its T-pose height above the floor.
[[nodiscard]] HumanPose posed_human(const HumanPosture& posture);

/// Returns a motion of a few seconds that covers common demands on limbs: arms hang, bend and reach
/// forward and up, legs step and squat.
/// @param forward  the human's facing direction; horizontal.
[[nodiscard]] HumanClip self_test_motion(const Eigen::Vector3d& forward);

}  // namespace retarget
