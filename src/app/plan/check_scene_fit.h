#pragma once

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/plan.h"

namespace retarget {

/// Compares the scene of a plan with its human, and records doubts: a human who never touches a
/// body of the scene, or who is inside one, suggests another unit or other axes.
/// Errors: those of place_scene and make_distance_field.
[[nodiscard]] Result<void> check_scene_fit(const Clip& clip, Plan& plan);

}  // namespace retarget
