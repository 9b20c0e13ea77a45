#pragma once

#include "retarget/motion.h"
#include "retarget/motion_io.h"

namespace retarget {

/// Applies normalize_start to a motion before writing; the human shown with it moves along.
void normalize_start(RobotClip& clip, WriteMotionOptions& write);

}  // namespace retarget
