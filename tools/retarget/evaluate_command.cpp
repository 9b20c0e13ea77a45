// `retarget evaluate`: how good robot motions are, held against gates.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "base/file.h"
#include "base/printable.h"
#include "base/try.h"
#include "commands.h"
#include "console.h"
#include "measure_files.h"
#include "plan/check_options.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "run/run_lines.h"
#include "run/written_files.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

Result<void> check_usage(const EvaluateArguments& arguments) {
  TRY(check_robot_choice(arguments.run.run.robot));
  TRY_ASSIGN(const auto read, check_inputs(arguments));
  return check_written({arguments.json, arguments.run.request.write_map}, read);
}

}  // namespace

Result<ExitCode> evaluate(const EvaluateArguments& arguments, Console& console) {
  TRY(check_usage(arguments));
  TRY_ASSIGN(const Measures measures, load_measures(arguments, console));
  std::vector<QualityReport> reports;
  for (const std::string& file : arguments.motions) {
    TRY_ASSIGN(MeasuredMotion motion, measure_file(file, measures, console));
    reports.push_back(std::move(motion.report));
  }
  if (!arguments.json.empty()) {
    TRY(write_file(arguments.json, printable_json(report_json(reports))));
  }
  if (arguments.json != "-") TRY(write_file("-", printable(report_text(reports))));
  for (const QualityReport& report : reports) console.lines(verdict_lines(report, report.file));
  // a motion that misses a gate is a result and no error, and the exit code tells it
  const bool passed = std::ranges::all_of(reports, &QualityReport::passed);
  return passed ? kDone : kRunFailed;
}

}  // namespace retarget::cli
