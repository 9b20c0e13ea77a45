#pragma once

#include <filesystem>

#include "base/file.h"
#include "console.h"
#include "options.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/report.h"
#include "retarget/robot.h"
#include "run_setup.h"

namespace retarget::cli {

/// The gates of configs/quality/default.json.
[[nodiscard]] Result<Gates> default_gates(const std::filesystem::path& data_folder);

/// What a run made, and from what.
struct RunReportInputs {
  const RobotClip& motion;
  const Source& source;
  const ResolvedMapping& tables;
  const LimitSet& limits;
  RobotCsvOptions csv;
};

/// Measures the motion as it was printed and holds it against the default gates.
[[nodiscard]] Result<QualityReport> measure_run(const RunOptions& options,
                                                const RunReportInputs& inputs,
                                                const std::filesystem::path& data_folder);

/// Writes --report, which commit() puts in its place, and says how many gates were missed.
[[nodiscard]] Result<OutputFile> write_run_report(const std::string& path,
                                                  const QualityReport& report, Console& console);

/// The end of a run's summary: gates that were missed, with their figures, and in one line whether
/// the gates were kept and which joint is at its limit most:
/// `16 of 16 gates kept; waist_pitch at its limit in 46 % of frames`.
/// @param file  the motion that it is about, where there may be several.
void print_verdict(const QualityReport& report, Console& console, const std::string& file = {});

}  // namespace retarget::cli
