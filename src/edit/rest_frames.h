#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// World rotations of all joints in the T-pose, in the canonical human's world, facing x. Joints
/// that turn no bone have zero rotation from their parent.
[[nodiscard]] std::vector<Eigen::Quaterniond> t_pose_rotations(const Skeleton& skeleton,
                                                               const Calibration& calibration);

/// What leaves a joint, its children and end sites: rest directions in two skeletons, pairwise.
struct Leaving {
  std::vector<Eigen::Vector3d> source, target;

  /// Such as have no length have no direction and are left out.
  void add(const Eigen::Vector3d& from_source, const Eigen::Vector3d& from_target);
};

/// What leaves a joint of the target and its twin, where it has twins.
/// @param twins  of target joints, in the source; -1: none.
/// @param turn   of the source's directions.
[[nodiscard]] Leaving leaving_of(const Skeleton& source, const Skeleton& target,
                                 const std::vector<int>& twins, int joint,
                                 const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity());

/// The rotation that takes the source's directions to the target's: the least one for one
/// direction, the best by least squares (Kabsch) for several, none where nothing leaves.
[[nodiscard]] Eigen::Quaterniond rest_turn(const Leaving& leaving);

/// How far the lowest point of the feet is below the hips (the bone's origin) in the T-pose,
/// metres; nothing for a body without hips or feet.
[[nodiscard]] std::optional<double> sole_depth(const Skeleton& skeleton,
                                               const Calibration& calibration);

/// How far a bone begins above that point in the T-pose, metres; nothing for a bone that is
/// missing.
[[nodiscard]] std::optional<double> rise_over_soles(const Skeleton& skeleton,
                                                    const Calibration& calibration, Bone bone);

}  // namespace retarget
