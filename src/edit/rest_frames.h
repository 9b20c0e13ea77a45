#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Returns the world rotations of all joints in the T-pose, in the canonical human's world, facing
/// x. Joints that turn no bone have zero rotation relative to their parent.
[[nodiscard]] std::vector<Eigen::Quaterniond> t_pose_rotations(const Skeleton& skeleton,
                                                               const Calibration& calibration);

/// Rest directions from a joint to its children and end sites, paired between two skeletons.
struct Leaving {
  std::vector<Eigen::Vector3d> source, target;

  /// Adds a pair; zero-length vectors have no direction and are ignored.
  void add(const Eigen::Vector3d& from_source, const Eigen::Vector3d& from_target);
};

/// Returns the rest directions from a target joint and its counterpart, for children that have
/// counterparts.
/// @param twins  index of each target joint's counterpart in the source; -1: none.
/// @param turn   rotation applied to the source's directions.
[[nodiscard]] Leaving leaving_of(const Skeleton& source, const Skeleton& target,
                                 const std::vector<int>& twins, int joint,
                                 const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity());

/// Returns the rotation from the source's to the target's directions: the minimal rotation for a
/// single direction, least squares (Kabsch) for several, identity without directions.
[[nodiscard]] Eigen::Quaterniond rest_turn(const Leaving& leaving);

/// Returns the depth of the feet's lowest point below the hips (the bone's origin) in the T-pose,
/// metres; nothing for a body without hips or feet.
[[nodiscard]] std::optional<double> sole_depth(const Skeleton& skeleton,
                                               const Calibration& calibration);

/// Returns the height of a bone's origin above that point in the T-pose, metres; nothing if the
/// bone is missing.
[[nodiscard]] std::optional<double> rise_over_soles(const Skeleton& skeleton,
                                                    const Calibration& calibration, Bone bone);

}  // namespace retarget
