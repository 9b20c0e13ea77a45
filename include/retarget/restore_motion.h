#pragma once

#include <memory>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/plan.h"
#include "retarget/solved_scene.h"

namespace RETARGET_API retarget {

/// The scene around the human of a motion that was solved elsewhere: SolvedScene::human, which
/// measurements need and which plan and clip determine.
/// @param plan      plan of the motion, with its clip.
/// @param prepared  prepare_clip(plan).
/// @return null: the plan has no scene. Errors (kInput): a track that does not fit the clip; a mesh
///     that is too large.
[[nodiscard]] Result<std::shared_ptr<const SceneWorld>> restore_human_scene(const Plan& plan,
                                                                            const Clip& prepared);

}  // namespace retarget
