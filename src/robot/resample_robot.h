#pragma once

#include "motion/resample.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/motion.h"

namespace retarget {

/// A robot motion at another frame rate, as resample() does it for clips: root position and joints
/// as tracks of numbers, the root's rotation as quaternions, sample i at time i / output rate.
[[nodiscard]] Result<RobotClip> resample_robot(const RobotClip& source,
                                               const FrameRate& output_rate,
                                               const ResampleOptions& options = {});

}  // namespace retarget
