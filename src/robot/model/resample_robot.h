#pragma once

#include "motion/resample.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/motion.h"

namespace retarget {

/// Resamples a robot motion to another frame rate, as resample() does for clips: root position and
/// joint positions as scalar tracks, the root's rotation as quaternions; sample i is at time i /
/// output rate.
[[nodiscard]] Result<RobotClip> resample_robot(const RobotClip& source,
                                               const FrameRate& output_rate,
                                               const ResampleOptions& options = {});

}  // namespace retarget
