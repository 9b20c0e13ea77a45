#pragma once

#include <vector>

#include "human/gait/seats.h"
#include "human/gait/source_feet.h"
#include "retarget/contact_plan.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/robot.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"

namespace retarget {

// Notes of a fit for the report: the terms that it omits, and assumptions about the floor.

/// Reports why the fit omits foot terms.
void note_missing_feet(const Robot& robot, const SourceSides& sides, FitReport& report);

/// Reports why the fit omits the dynamics term.
void note_dynamics(const FitOptions& options, const FitModel& model, FitReport& report);

/// Reports that the feet stand on surfaces that are not in the source: boxes and steps, or errors
/// of the root's height that look like them.
void note_raised_feet(const FitClip& clip, FitReport& report);

/// Reports that the human sits on something that is not in the motion.
void note_seats(const std::vector<SeatRest>& seats, const FitClip& clip, double floor,
                FitReport& report);

/// Reports that the floor is not that of feet.
void note_floor(const StandingHeights& standing, FitReport& report);

}  // namespace retarget
