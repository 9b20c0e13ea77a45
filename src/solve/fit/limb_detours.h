#pragma once

#include <functional>
#include <vector>

#include "retarget/clip.h"
#include "retarget/options.h"
#include "solve/fit/branch_recovery.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/limb_solver.h"

namespace retarget {

/// The part of a limb that determines its branch: the joints that carry its upper and lower bones,
/// and the tasks of these bones. The wrist can follow any branch.
[[nodiscard]] FitLimb without_hand(const FitModel& model, const FitLimb& limb);

/// The intervals in which an arm is astray (astray_cost()), with a margin on either side.
[[nodiscard]] std::vector<FrameRange> astray_intervals(const FitModel& model, const FitClip& clip,
                                                       const FitLimb& arm);

/// Searches intervals of a fitted clip in which an arm is far from its targets because its shoulder
/// is at a limit or cannot turn fast enough near a singularity. Moves the arm to the best path over
/// all branches (LimbPathFinder) if that clearly lowers the cost of all terms. All other frames
/// stay bitwise unchanged.
/// @param astray      astray_intervals() before any limb moved. The other arm may since have moved
///     and released the trunk. Without these intervals, only one of two symmetric arms would move.
/// @param keep_going  called periodically; returning false stops the search.
/// @param result      receives the changes and failures.
void straighten_arm(const FitModel& model, const FitOptions& options, FitClip& clip,
                    const FitLimb& arm, const std::vector<FrameRange>& astray,
                    const std::function<bool()>& keep_going, BranchRecovery& result);

}  // namespace retarget
