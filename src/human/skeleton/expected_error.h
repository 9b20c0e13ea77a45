#pragma once

#include "human/skeleton/learned_axes.h"

namespace retarget {

/// Mean deviation of a frame that may be an inexact T-pose or A-pose, degrees.
inline constexpr double kNearlyT = 20.0;

/// Returns the expected error of learned axes in degrees, root mean square over hips, torso, legs,
/// feet and arms.
[[nodiscard]] double expected_error(const LearnedAxes& learned);

/// Returns the expected error of other axes, such as those of a rest pose, in degrees: their angle
/// to the learned axes beyond the expected error of these. Each bone is weighted by the certainty
/// of its learned axes.
[[nodiscard]] double expected_error(const JointFromBone& axes, const LearnedAxes& learned);

/// Returns the expected error of the axes of a pose that need not be a T-pose. In expected_error(),
/// bones whose axes the movement does not show, such as arms without a length, have almost no
/// weight, so that any pose seems to fit. Here they have the error of unknown axes, in full for
/// poses 60 degrees or more off a T-pose.
/// @param off  mean deviation of the pose from a T-pose, degrees
[[nodiscard]] double expected_error_of_pose(const JointFromBone& axes, double off,
                                            const LearnedAxes& learned);

/// Returns the root mean square angle between two sets of axes in degrees, over the bones that both
/// have.
[[nodiscard]] double angle_between_axes(const JointFromBone& a, const JointFromBone& b);

}  // namespace retarget
