#pragma once

#include <memory>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/plan.h"
#include "scene/scene_world.h"

namespace retarget {

/// Loads the scene and the object tracks that the options of a plan name, and notes them. A track
/// in the file of the clip gets the rate of the clip if the user states it. Errors: those of
/// load_scene and load_object_track.
[[nodiscard]] Result<void> load_surroundings(const Clip& clip, Plan& plan);

/// The scene around the human in the frames of a motion; null if the plan has none.
/// @param plan      plan with its clip.
/// @param prepared  result of prepare_clip for it.
/// Errors: those of place_scene and make_distance_field.
[[nodiscard]] Result<std::shared_ptr<const SceneWorld>> human_surroundings(const Plan& plan,
                                                                           const Clip& prepared);

}  // namespace retarget
