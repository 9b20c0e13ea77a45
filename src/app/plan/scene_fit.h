#pragma once

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/plan.h"

namespace retarget {

/// Whether the feet of a plan's human stand on a body while its track moves it, in a fifth of the
/// frames or more. Errors: those of place_scene and make_distance_field.
[[nodiscard]] Result<bool> stands_on_moving_body(const Clip& clip, const Plan& plan);

/// Compares the scene of a plan with its human, and records warnings: a human who never touches a
/// body of the scene, or who is inside one, suggests another unit or other axes.
/// Errors: those of place_scene and make_distance_field.
[[nodiscard]] Result<void> check_scene_fit(const Clip& clip, Plan& plan);

}  // namespace retarget
