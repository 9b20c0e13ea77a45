#pragma once

#include "retarget/human.h"
#include "retarget/motion_io.h"

namespace retarget {

/// A clip as its calibration places it, left and right in colours of their own.
/// @param clip  must outlive the result.
[[nodiscard]] HumanInWorld human_in_world(const Clip& clip, const Calibration& calibration);

/// normalize_start of a motion that will be written; the human beside it moves along.
void normalize_start(RobotClip& clip, WriteMotionOptions& write);

}  // namespace retarget
