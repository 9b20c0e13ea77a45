#pragma once

#include "human/skeleton/learned_axes.h"
#include "human/skeleton/rest_pose.h"

namespace retarget {

/// Returns the expected error of learned axes in degrees, root mean square over hips, torso, legs,
/// feet and arms.
[[nodiscard]] double expected_error(const LearnedAxes& learned);

/// Returns the expected error of other axes, such as those of a rest pose, in degrees: their angle
/// to the learned axes beyond the expected error of these. Each bone is weighted by the certainty of
/// its learned axes.
[[nodiscard]] double expected_error(const JointFromBone& axes, const LearnedAxes& learned);

/// Returns the root mean square angle between two sets of axes in degrees, over the bones that both have.
[[nodiscard]] double angle_between_axes(const JointFromBone& a, const JointFromBone& b);

}  // namespace retarget
