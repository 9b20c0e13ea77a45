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

/// Whether the feet of a plan's human stand on a body while its track moves it, in a fifth of the
/// frames or more. Errors: those of place_scene and make_distance_field.
[[nodiscard]] Result<bool> stands_on_moving_body(const Clip& clip, const Plan& plan);

/// Compares the scene of a plan with its human, and records warnings: a human who never touches a
/// body of the scene, or who is inside one, suggests another unit or other axes.
/// Errors: those of place_scene and make_distance_field.
[[nodiscard]] Result<void> check_scene_fit(const Clip& clip, Plan& plan);

/// Puts terrain under the human of a plan, or changes the bodies of its scene, according to
/// SolveOptions::terrain, ::terrain_scale, ::object_shift and ::object_scale. Moves the human in
/// the clip with its contacts, and notes the changes.
///
/// Errors: a human who does not walk, for terrain (kInput); a change of bodies that the scene does
/// not have (kUsage); those of place_scene and make_distance_field.
/// @pre all other members of the plan, except its clip, are known
[[nodiscard]] Result<void> vary_scene(Clip& clip, Plan& plan);

}  // namespace retarget
