#pragma once

#include <string>
#include <vector>

#include "human/gait/seats.h"
#include "retarget/contact_plan.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/robot.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/frame_terms.h"

namespace retarget {

/// Writes the final status of each window and of the whole clip to the report, with notes and
/// failures.
/// @param parts          statuses of the windows, then of the seams.
/// @param before, after  costs of the start and of the result, by frame.
void report_status(std::vector<FitStatus> parts, const std::vector<TermCosts>& before,
                   const std::vector<TermCosts>& after, FitReport& report);

/// A message about the window farthest from convergence; empty if all windows have converged. Most
/// fits with dynamics are good before they converge, so summaries show it only if a gate is missed.
[[nodiscard]] std::string convergence_note(const FitReport& report);

/// Writes the mean cost of each term before and after the fit, and its worst frames, to the report.
/// @param before, after  costs of the start and of the result, by frame.
void report_terms(const FitClip& clip, const std::vector<TermCosts>& before,
                  const std::vector<TermCosts>& after, FitReport& report);

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
