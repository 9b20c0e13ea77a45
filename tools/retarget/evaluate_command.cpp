// `retarget evaluate`: measures the quality of robot motions and checks it against gates.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "measure_files.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/measure.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

Result<void> check_usage(const EvaluateArguments& arguments) {
  RETARGET_TRY(check_robot_choice(arguments.run.run.robot));
  RETARGET_TRY_ASSIGN(const auto read, check_inputs(arguments));
  return check_written({arguments.json, arguments.run.request.write_map}, read);
}

}  // namespace

Result<ExitCode> evaluate(const EvaluateArguments& arguments, Console& console) {
  RETARGET_TRY(check_usage(arguments));
  RETARGET_TRY_ASSIGN(const MeasureRequest request, measure_request(arguments));
  RETARGET_TRY_ASSIGN(const Measures measures, load_measures(request, console));
  std::vector<QualityReport> reports;
  for (const std::string& file : arguments.motions) {
    RETARGET_TRY_ASSIGN(MeasuredMotion motion, measure_file(file, measures, console));
    reports.push_back(std::move(motion.report));
  }
  if (!arguments.json.empty()) {
    RETARGET_TRY(write_file(arguments.json, printable_json(report_json(reports))));
  }
  if (arguments.json != "-") {
    const ReportStyle style{.all = arguments.all, .colour = output_takes_colours()};
    RETARGET_TRY(write_file("-", report_text(reports, style)));
    if (!arguments.all) console.line("figures", "--all prints all measured metrics");
  }
  for (const QualityReport& report : reports) console.lines(verdict_lines(report, report.file));
  // A missed gate is a result, not an error; the exit code reports it.
  const bool passed = std::ranges::all_of(reports, &QualityReport::passed);
  return passed ? kDone : kRunFailed;
}

}  // namespace retarget::cli
