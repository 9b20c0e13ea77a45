#pragma once

#include <functional>

#include "retarget/options.h"
#include "solve/fit/branch_recovery.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// Solves intervals of a fitted clip again in which a point of the robot is more than a centimetre
/// below the floor. There, the windows have not converged, mostly because a limb reached its limit
/// in an early step. Keeps the result if it clearly lowers the cost of all terms. All other frames
/// stay bitwise unchanged. Scenes have no such floor: without effect.
/// @param keep_going  called periodically; returning false stops the search.
/// @param result      receives the failures.
void solve_sunken_frames(const FitModel& model, const FitOptions& options, FitClip& clip,
                         const std::function<bool()>& keep_going, BranchRecovery& result);

/// Solves intervals of a fitted clip again in which limbs pass through each other, or through the
/// body, between two frames; now with self-collision terms half-way between the frames. Keeps the
/// result if the overlaps are clearly smaller, the cost of the terms in the frames is hardly larger,
/// and, with dynamics, contacts can supply the forces as well. All other frames stay bitwise
/// unchanged.
/// @param keep_going  called periodically; returning false stops the search.
/// @param result      receives the failures.
void solve_crossing_frames(const FitModel& model, const FitOptions& options, FitClip& clip,
                           const std::function<bool()>& keep_going, BranchRecovery& result);

}  // namespace retarget
