#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "human/skeleton/calibrate.h"
#include "human/skeleton/learned_axes.h"
#include "human/skeleton/posed_body.h"
#include "human/skeleton/rest_pose.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/options.h"

namespace retarget {

/// The sampled poses of a movement.
struct Movement {
  int lead_in = 0;          ///< Number of frames before the motion.
  std::vector<int> frames;  ///< Sampled frames (sampled_frames).
  std::vector<JointPoses> poses;
  SignedAxis up;
};

/// The pose that is converted to a T-pose, and the resulting axes.
struct Rest {
  RestCandidate candidate;
  JointFromBone axes;
  std::string name;      ///< See Calibration::rest_pose.
  std::string evidence;  ///< Comparison with the runner-up, human-readable; may be empty.
  std::string doubt;     ///< Reason why it may be wrong; empty: no doubt.
};

/// Inputs of the search for a rest pose.
struct RestSearch {
  const Clip& clip;
  const BoneMap& map;
  const CalibrationOptions& options;
  const Body& body;
  const Movement& movement;
};

/// Chooses the rest pose of a clip according to its CalibrationOptions. RestPose and docs/human.md
/// document the rules.
[[nodiscard]] Result<Rest> find_rest(const RestSearch& search);
/// The pose with all rotations zero, along its own axes; nothing if its facing is undefined.
[[nodiscard]] std::optional<RestCandidate> zero_candidate(const RestSearch& search);
/// The frame closest to a T-pose and its number, from the movement and its lead-in.
[[nodiscard]] std::optional<std::pair<int, RestCandidate>> best_frame(const RestSearch& search);

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
