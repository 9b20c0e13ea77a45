#pragma once

#include <cstddef>
#include <vector>

#include "retarget/clip.h"
#include "retarget/pose.h"

namespace retarget {

/// Poses of all joints in a frame.
inline std::vector<Pose> world_poses(const Clip& clip, int frame) {
  std::vector<Pose> poses(static_cast<std::size_t>(clip.skeleton().joint_count()));
  forward_kinematics(clip, frame, poses);
  return poses;
}

}  // namespace retarget
