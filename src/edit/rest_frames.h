#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "retarget/human/human_clip.h"
#include "retarget/motion/skeleton.h"

namespace retarget {

/// World rotations of all joints in the T-pose, in the canonical human's world, facing x. Joints
/// that turn no bone have zero rotation from their parent.
[[nodiscard]] std::vector<Eigen::Quaterniond> t_pose_rotations(const Skeleton& skeleton,
                                                               const HumanMapping& mapping);

/// How far the lowest point of the feet is below the hips (the bone's origin) in the T-pose, metres;
/// nothing for a body without hips or feet.
[[nodiscard]] std::optional<double> sole_depth(const Skeleton& skeleton,
                                               const HumanMapping& mapping);

}  // namespace retarget
