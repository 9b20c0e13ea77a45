#pragma once

#include <string>
#include <vector>

#include "quality/measure.h"
#include "retarget/clip.h"
#include "retarget/load.h"
#include "retarget/report.h"
#include "retarget/solve.h"
#include "retarget/view.h"

namespace retarget {

/// Lines of the summary of a run.

/// The clip as it was read.
[[nodiscard]] SummaryLine clip_line(const Clip& clip);
/// What a fit found and what is left; has_floor: of a robot that stands on one; verbose: also what
/// its terms cost.
[[nodiscard]] std::vector<SummaryLine> fit_lines(const FitReport& report, bool has_floor,
                                                 bool verbose);
/// How near the motion comes to the joint limits, which joints stay at one, and why.
[[nodiscard]] std::vector<SummaryLine> limit_lines(const Motion& motion);

/// How many bodies of a page have meshes, and which are lacking; nothing where a robot has none.
[[nodiscard]] std::vector<SummaryLine> mesh_lines(const RobotMeshes& meshes);
/// A gate that was missed: `jumps 3 (at most 0)`.
/// @pre its figure was measured
[[nodiscard]] std::string missed_text(const GateResult& gate);
/// All of a report, parted by commas; empty: none was.
[[nodiscard]] std::string missed_gates_text(const QualityReport& report);

/// Gates that were missed, with their figures, and in one line whether the gates were kept and which
/// joint is at its limit most: `16 of 16 gates kept; waist_pitch at its limit in 46 % of frames`.
/// @param file  the motion that it is about, where there may be several.
[[nodiscard]] std::vector<SummaryLine> verdict_lines(const QualityReport& report,
                                                     const std::string& file = {});

}  // namespace retarget
