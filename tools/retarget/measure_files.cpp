#include "measure_files.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/check_options.h"
#include "retarget/compare.h"
#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/measure.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

// `retarget evaluate`: measures the quality of robot motions and checks it against gates.

Result<void> check_usage(const EvaluateArguments& arguments) {
  RETARGET_TRY(check_robot_choice(arguments.run.run.robot));
  RETARGET_TRY_ASSIGN(const auto read, check_inputs(arguments));
  return check_written({arguments.json, arguments.run.request.write_map}, read);
}

// `retarget compare`: checks whether two motions agree.

// Without a robot the files are compared as raw tables, so reading options have no meaning.
Result<void> check_no_reading(const ReadingOptions& reading) {
  const bool given = reading.from || reading.source_fps > 0.0 || reading.quaternion ||
                     !reading.angles.empty() || !reading.unit.empty() || !reading.dof.empty() ||
                     !reading.motion.empty() || reading.ignore_header;
  if (!given) return {};
  return usage_failure(
      "options for reading the files need a robot; without a robot, files are compared "
      "unchanged",
      "add --robot NAME");
}

using MotionTables = std::array<MotionTable, 2>;

Result<MotionTables> load_as_they_are(const CompareArguments& arguments) {
  RETARGET_TRY(check_no_reading(arguments.reading));
  MotionTables tables;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string& file = i == 0 ? arguments.a : arguments.b;
    RETARGET_TRY_ASSIGN(tables[i], load_motion_table(file, memory_share(arguments.memory_gb)));
  }
  return tables;
}

Result<MotionTables> load_of_robot(const CompareArguments& arguments, Console& console) {
  RETARGET_TRY(check_robot_choice(arguments.robot));
  RETARGET_TRY_ASSIGN(const LoadedRobot chosen,
                      load_robot(arguments.robot, arguments.common, console, Soles::kAsTheyAre));
  const auto read_options =
      read_motion_options(arguments.reading, memory_share(arguments.memory_gb));
  MotionTables tables;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string& file = i == 0 ? arguments.a : arguments.b;
    RETARGET_TRY_ASSIGN(const auto motion, load_recorded_motion(file, chosen.robot, read_options));
    report_reading(file, motion, console);
    tables[i] = motion_table(motion.clip);
    if (motion.rate_known) tables[i].others = {{"fps", {motion.clip.rate().fps()}}};
  }
  // Compare rates only if both files state one.
  if (tables[0].others.empty() || tables[1].others.empty()) {
    tables[0].others = tables[1].others = {};
  }
  return tables;
}

}  // namespace

Result<std::vector<std::string>> check_inputs(const MeasureArguments& arguments) {
  const Run& run = arguments.run.run;
  const bool source = !run.motion.empty() || !arguments.run.smpl_file.empty();
  const PartOptions& part = run.options.part;
  const char* const of_source = arguments.fps == "source" ? "--fps source"
                                : part.start_s >= 0.0     ? "--start"
                                : part.end_s >= 0.0       ? "--end"
                                : !part.frames.empty()    ? "--frames"
                                                          : nullptr;
  if (!source && of_source != nullptr) {
    return usage_failure(std::string(of_source) + " needs the source", "add --bvh FILE");
  }
  const auto inputs = std::ranges::count(arguments.motions, "-") + (run.motion == "-" ? 1 : 0);
  if (inputs > 1) return usage_failure("standard input can be read only once");
  std::vector<std::string> read = files_read(run, arguments.run.common);
  read.insert(read.end(), arguments.motions.begin(), arguments.motions.end());
  read.insert(read.end(), arguments.gates.begin(), arguments.gates.end());
  read.push_back(arguments.run.smpl_file);
  return read;
}

Result<MeasureRequest> measure_request(const MeasureArguments& arguments) {
  RunArguments with_file = arguments.run;
  RETARGET_TRY(take_smpl_file(with_file));
  return MeasureRequest{std::move(with_file.run),
                        std::move(with_file.request),
                        arguments.fps,
                        arguments.reading,
                        arguments.motions,
                        arguments.gates,
                        arguments.dynamics,
                        DataFolder{with_file.common.data_dir}};
}

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
    if (!arguments.all) console.line("metrics", "--all prints all measured metrics");
  }
  for (const QualityReport& report : reports) console.lines(verdict_lines(report, report.file));
  // A missed gate is a result, not an error; the exit code reports it.
  const bool passed = std::ranges::all_of(reports, &QualityReport::passed);
  return passed ? kDone : kRunFailed;
}

Result<void> compare(const CompareArguments& arguments, Console& console) {
  if (arguments.a == "-" && arguments.b == "-") {
    return usage_failure("standard input can be read only once");
  }
  const bool has_robot = !arguments.robot.name.empty() || !arguments.robot.model.empty();
  RETARGET_TRY_ASSIGN(const auto tables,
                      has_robot ? load_of_robot(arguments, console) : load_as_they_are(arguments));
  RETARGET_TRY_ASSIGN(const auto found, compare_motions(tables[0], tables[1], arguments.tolerance));
  const char* label = "compared";
  for (const std::string& line : difference_lines(found)) {
    console.line(label, line);
    label = "";
  }
  return check_agreement(found, arguments.tolerance, arguments.a, arguments.b);
}

// `retarget verify`: checks that a run still gives the bytes and the report in its sidecar.

Result<void> verify(const VerifyArguments& arguments, Console& console) {
  return verify_run(arguments.file, DataFolder{arguments.common.data_dir}, console);
}

}  // namespace retarget::cli
