#pragma once

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/plan.h"

namespace retarget {

/// Puts terrain under the human of a plan, or changes the bodies of its scene, according to
/// SolveOptions::terrain, ::terrain_scale, ::object_shift and ::object_scale. Moves the human in
/// the clip with its contacts, and notes the changes.
///
/// Errors: a human who does not walk, for terrain (kInput); a change of bodies that the scene does
/// not have (kUsage); those of place_scene and make_distance_field.
/// @pre all other members of the plan, except its clip, are known
[[nodiscard]] Result<void> vary_scene(Clip& clip, Plan& plan);

}  // namespace retarget
