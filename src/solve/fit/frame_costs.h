#pragma once

#include <span>

#include "retarget/options.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/frame_terms.h"

namespace retarget {

/// Number of frames over which smoothed velocities influence each other.
[[nodiscard]] int smoothing_context(double frame_time);

/// Computes the cost of each frame of a window, by term. Smoothness and speed of a step count for
/// its first frame. Without fixed ends, frames outside the window are not read.
/// @param costs  one entry per frame of the window; overwritten.
void frame_costs(const FitModel& model, const FitOptions& options, const FitClip& clip,
                 const FitWindow& window, std::span<TermCosts> costs);

}  // namespace retarget
