#pragma once

#include "retarget/clip.h"
#include "retarget/plan.h"

namespace retarget {

/// Takes the weight of rotations from tasks of bones whose rotations the clip's file does not tell
/// (ClipOrigin::unknown_rotations). @pre the plan has its human and its configuration
void leave_out_unknown_rotations(const Clip& clip, Plan& plan);

}  // namespace retarget
