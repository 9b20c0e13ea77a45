#pragma once

#include <span>

#include "retarget/options.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/frame_terms.h"

namespace retarget {

/// Number of frames over which the smoothing of velocities has a noticeable effect.
/// @param frame_time  seconds.
[[nodiscard]] int smoothing_context(double frame_time);

/// Computes the cost of each frame of a window, by term. The smoothness and speed costs of a step
/// belong to its first frame. Without fixed ends, it reads no frame outside the window.
/// @param costs  one entry per frame of the window; overwritten.
void frame_costs(const FitModel& model, const FitOptions& options, const FitClip& clip,
                 const FitWindow& window, std::span<TermCosts> costs);

}  // namespace retarget
