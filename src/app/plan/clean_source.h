#pragma once

#include <string>

#include "retarget/clip.h"
#include "retarget/plan.h"

namespace retarget {

/// Smooths noisy joint positions of a clip according to HumanOptions::clean, before its human is
/// recognised.
/// @return a sentence that describes the changes; empty: no changes.
[[nodiscard]] std::string clean_source_positions(Clip& clip, const Options& options);

/// Removes noise from the part of a clip that a plan uses, according to HumanOptions::clean, and
/// records the changes. Raises the fit's contact thresholds (speeds and heights) above the residual
/// speed of standing feet, up to a limit.
/// @param positions  result of clean_source_positions().
/// @pre the plan's options, human, part and fit are known
void clean_source(Clip& clip, const std::string& positions, Plan& plan);

}  // namespace retarget
