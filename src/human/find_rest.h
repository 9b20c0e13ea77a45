#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "human/calibrate.h"
#include "human/rest_pose.h"

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

/// Chooses the rest pose of a clip as CalibrationOptions say; RestPose and docs/human.md have the
/// rules. Refers to all that it is given.
class RestFinder {
 public:
  RestFinder(const Clip& clip, const BoneMap& map, const CalibrationOptions& options,
             const std::string& file, const Body& body, const Movement& movement)
      : clip_(clip), map_(map), options_(options), file_(file), body_(body), movement_(movement) {}

  [[nodiscard]] Result<Rest> find() const;
  /// All rotations zero, along its own axes; nothing when it shows no facing.
  [[nodiscard]] std::optional<RestCandidate> zero_candidate() const;
  /// The frame most like a T-pose and its number, of the movement and what is in front of it.
  [[nodiscard]] std::optional<std::pair<int, RestCandidate>> best_frame() const;

 private:
  [[nodiscard]] std::optional<RestCandidate> candidate(JointPoses pose,
                                                       const Eigen::Vector3d& up) const;
  [[nodiscard]] std::optional<Rest> rest_of_dialect() const;
  [[nodiscard]] Result<Rest> rest_of_movement() const;
  [[nodiscard]] Result<Rest> with_arms_of_movement(Result<Rest> rest) const;
  [[nodiscard]] Result<Rest> told_rest() const;
  [[nodiscard]] Result<Rest> rest_of_tpose_file() const;
  [[nodiscard]] Result<Rest> taken(std::optional<RestCandidate> candidate, std::string name) const;

  const Clip& clip_;
  const BoneMap& map_;
  const CalibrationOptions& options_;
  const std::string& file_;
  const Body& body_;
  const Movement& movement_;
};

}  // namespace retarget
