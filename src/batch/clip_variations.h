#pragma once

#include <string>
#include <vector>

#include "batch/find_inputs.h"
#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// Returns the inputs followed by `count` variations of each, in which the scene is changed at random:
/// the sizes of SolveOptions::terrain; else position and size of the objects, if there are tracks;
/// else the heights of the scene. The changes depend only on the seed, the clip's name and the number
/// of the variation.
/// Errors (kUsage): the options have no scene.
[[nodiscard]] Result<std::vector<BatchInput>> with_variations(std::vector<BatchInput> inputs,
                                                              int count, int seed,
                                                              const SolveOptions& options);

/// Applies ClipVariant::changes to options. Unknown changes are ignored.
void apply_changes(const std::string& changes, SolveOptions& options);

}  // namespace retarget
