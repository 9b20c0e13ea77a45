#pragma once

#include <span>

#include "retarget/fit_options.h"
#include "retarget/kinematic_tree.h"
#include "robot/model/composite.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/fit_scene.h"

namespace retarget {

/// Costs of a frame's scene terms.
struct SceneCosts {
  double contact = 0.0, penetration = 0.0;
};

/// Adds a frame's scene terms: contacts touch their surfaces, and no link penetrates a body.
/// @param stands      one per foot: whether an end of it is in contact, and it does not lie.
/// @param composites  one per link; the terms' Hessians and gradients are added to them.
SceneCosts add_scene_terms(const FitModel& model, const FitOptions& options, const FitScene& scene,
                           int frame, const TreeState& pose, std::span<const char> stands,
                           std::span<Composite> composites);

}  // namespace retarget
