#pragma once

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/plan.h"

namespace retarget {

/// The scale from the paths of the human's feet to those of the robot's.
/// Errors: the targets cannot be made (kInput, kConfig).
/// @pre the plan's robot, human, configuration and scale are known
[[nodiscard]] Result<double> foot_path_scale(const Clip& clip, const Plan& plan);

}  // namespace retarget
