#pragma once

#include <span>

#include "fit/fit_clip.h"
#include "fit/fit_model.h"
#include "fit/frame_terms.h"
#include "retarget/options.h"

namespace retarget {

/// Frames within which smoothed velocities depend on each other.
[[nodiscard]] int smoothing_context(double frame_time);

/// What each frame of a window costs, by term. The smoothness and speed of the step to the next
/// frame count for the earlier one; without fixed ends no frame outside the window is read.
/// @param costs  of the window's frames, written.
void frame_costs(const FitModel& model, const FitOptions& options, const FitClip& clip,
                 const FitWindow& window, std::span<TermCosts> costs);

}  // namespace retarget
