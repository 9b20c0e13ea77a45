#pragma once

#include "retarget/human.h"
#include "retarget/motion_io.h"

namespace retarget {

/// Returns a clip in its calibrated world position, with separate colours for left and right.
/// @param clip  must outlive the result.
[[nodiscard]] HumanInWorld human_in_world(const Clip& clip, const Calibration& calibration);

/// Applies normalize_start to a motion before writing; the human shown with it moves along.
void normalize_start(RobotClip& clip, WriteMotionOptions& write);

}  // namespace retarget
