#pragma once

#include <span>

#include "retarget/clip.h"
#include "retarget/pose.h"

namespace retarget {

/// World poses of all joints in one frame, in file units and axes.
/// @param world_from_joint  one pose per joint, in joint order; overwritten.
void forward_kinematics(const Clip& clip, int frame, std::span<Pose> world_from_joint);

}  // namespace retarget
