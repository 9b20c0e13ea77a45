#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "retarget/human/human_clip.h"
#include "retarget/motion/skeleton.h"

namespace retarget {

/// World rotations of all joints in the T-pose, in the canonical human's world, facing x. Joints
/// that turn no bone have zero rotation from their parent.
[[nodiscard]] std::vector<Eigen::Quaterniond> t_pose_rotations(const Skeleton& skeleton,
                                                               const HumanMapping& mapping);

}  // namespace retarget
