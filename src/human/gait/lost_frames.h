#pragma once

#include <string>
#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// Interpolates over frames in which a joint is lost: its rotation is exactly zero for at most a
/// second, the joint is far from zero before and after and jumps in one frame, while other joints
/// continue to move.
/// @return one sentence per joint: `LeftForeArm was lost in 9 frames`.
std::vector<std::string> bridge_lost_joints(Clip& clip, FrameRange part);

/// Interpolates over frozen frames: at least three equal ones in a row within a movement, followed
/// by a jump to where the body would have moved. Clips with more than a third of such frames stay
/// unchanged: they were upsampled from fewer frames.
/// @return number of interpolated frames.
int bridge_frozen_frames(Clip& clip, FrameRange part);

}  // namespace retarget
