#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/motion.h"

namespace retarget {

/// Evenly from the first frame to the last.
/// @param poses  at least one; no more than there are frames are taken.
[[nodiscard]] std::vector<int> spread_frames(int frame_count, int poses);

/// Where the robot faces on the whole in these frames, of any length: x is ahead in every robot's root.
[[nodiscard]] Eigen::Vector3d facing(const RobotClip& motion, const std::vector<int>& frames);

}  // namespace retarget
