#pragma once

#include "retarget/clip.h"
#include "retarget/plan.h"

namespace retarget {

/// Sets the rotation weights to zero for tasks of bones whose rotations are unknown
/// (ClipOrigin::unknown_rotations).
/// @pre the plan has its human and its configuration
void leave_out_unknown_rotations(const Clip& clip, Plan& plan);

}  // namespace retarget
