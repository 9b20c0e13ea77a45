#pragma once

#include <string>
#include <vector>

#include "retarget/report.h"
#include "solve/fit/fit_clip.h"
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

}  // namespace retarget
