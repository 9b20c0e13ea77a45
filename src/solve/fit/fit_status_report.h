#pragma once

#include <vector>

#include "retarget/report.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/frame_terms.h"

namespace retarget {

/// Reports the final status of every window and of the whole clip, and adds notes.
/// @param parts          windows, then seams.
/// @param before, after  costs by frame.
void report_status(std::vector<FitStatus> parts, const std::vector<TermCosts>& before,
                   const std::vector<TermCosts>& after, FitReport& report);

/// Reports the mean cost of each term before and after, and its worst frames.
/// @param before, after  costs by frame.
void report_terms(const FitClip& clip, const std::vector<TermCosts>& before,
                  const std::vector<TermCosts>& after, FitReport& report);

}  // namespace retarget
