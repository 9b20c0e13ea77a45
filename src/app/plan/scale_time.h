#pragma once

#include <vector>

#include "retarget/error.h"
#include "retarget/load.h"
#include "retarget/plan.h"
#include "retarget/solve.h"
#include "retarget/time_scale.h"

namespace retarget {

/// A time scale with the same factor everywhere.
/// @param duration  duration of the source, seconds.
[[nodiscard]] TimeScale constant_time_scale(double factor, double duration);

/// Sets Plan::time_scale if the options give a factor, and notes it.
[[nodiscard]] Result<void> set_time_scale(Plan& plan);

/// Summary lines with the slowed intervals and their factors.
[[nodiscard]] std::vector<SummaryLine> time_scale_lines(const TimeScale& scale);

/// Solves a plan whose time scale is decided.
/// @param limit_speeds  false: without joint speed limits, as FitRun::limit_speeds.
[[nodiscard]] Result<Motion> solve_in_time(Plan plan, const SolveControl& control,
                                           bool limit_speeds);

}  // namespace retarget
