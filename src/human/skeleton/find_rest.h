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

}  // namespace retarget
