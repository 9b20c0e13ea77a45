#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "human/calibrate.h"
#include "human/posed_body.h"
#include "human/rest_pose.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/options.h"

namespace retarget {

/// What is seen of a movement.
struct Movement {
  int lead_in = 0;          ///< Frames in front that are none of it.
  std::vector<int> frames;  ///< That are looked at: sampled_frames.
  std::vector<JointPoses> poses;
  SignedAxis up;
};

/// The pose that is brought to T, and the axes it gives.
struct Rest {
  RestCandidate candidate;
  JointFromBone axes;
  std::string name;  ///< As Calibration::rest_pose.
};

/// What a rest pose is looked for in.
struct RestSearch {
  const Clip& clip;
  const BoneMap& map;
  const CalibrationOptions& options;
  const Body& body;
  const Movement& movement;
};

/// Chooses the rest pose of a clip as CalibrationOptions say; RestPose and docs/human.md have the
/// rules.
[[nodiscard]] Result<Rest> find_rest(const RestSearch& search);
/// All rotations zero, along its own axes; nothing when it shows no facing.
[[nodiscard]] std::optional<RestCandidate> zero_candidate(const RestSearch& search);
/// The frame most like a T-pose and its number, of the movement and what is in front of it.
[[nodiscard]] std::optional<std::pair<int, RestCandidate>> best_frame(const RestSearch& search);

}  // namespace retarget
