#include "run_report.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/file.h"
#include "quality/measure.h"
#include "read_source.h"
#include "robot/normalize_start.h"
#include "robot_mapping.h"

namespace retarget::cli {

namespace fs = std::filesystem;

Result<Gates> default_gates(const fs::path& data_folder) {
  Gates gates;
  const fs::path file = data_folder / "configs" / "quality" / "default.json";
  if (auto added = gates.add_file(file.string()); !added) return failure(added.error());
  return gates;
}

namespace {

constexpr int kDecimals = 3, kMostDecimals = 9;

// two digits at least that say something
std::string bound_text(double bound) {
  int decimals = kDecimals;
  for (double size = std::abs(bound) * 1000.0;
       size > 0.0 && size < 10.0 && decimals < kMostDecimals; size *= 10.0) {
    ++decimals;
  }
  return number_text(bound, decimals);
}

// `jumps 3 (at most 0)`
std::string missed_text(const GateResult& gate) {
  // written so that NaN is below every bound
  const bool too_little = gate.least && !(*gate.value >= *gate.least);
  const double bound = too_little ? *gate.least : *gate.most;
  // as many digits as it takes to see that it was missed
  int decimals = kDecimals;
  while (decimals < kMostDecimals &&
         number_text(*gate.value, decimals) == number_text(bound, decimals)) {
    ++decimals;
  }
  return gate.metric + " " + number_text(*gate.value, decimals) +
         (too_little ? " (at least " : " (at most ") + bound_text(bound) + ")";
}

// without the ending that many models' joints have
std::string short_name(const std::string& joint) {
  constexpr std::string_view kEnding = "_joint";
  const bool has_it = joint.size() > kEnding.size() && joint.ends_with(kEnding);
  return has_it ? joint.substr(0, joint.size() - kEnding.size()) : joint;
}

}  // namespace

Result<QualityReport> measure_run(const RunOptions& options, const RunReportInputs& inputs,
                                  const fs::path& data_folder) {
  const auto gates = default_gates(data_folder);
  if (!gates) return failure(gates.error());
  // what counts is what was printed, digits cut off and all
  RobotClip moved = inputs.motion;
  if (options.normalize_start) normalize_start(moved);
  auto printed = printed_clip(moved, inputs.csv.precision);
  if (!printed) {
    printed.error().location.file = options.output;
    return failure(printed.error());
  }
  const HumanClip human = to_human(inputs.source.clip, inputs.source.human.calibration.mapping);
  const QualitySource source{
      &human, &inputs.tables,
      choose_scale(inputs.source.human, inputs.motion.robot(), inputs.tables, options)};
  QualityReport report = measure_quality(*printed, inputs.limits, &source);
  report.file = options.output == "-" ? "-" : fs::path(options.output).filename().string();
  report.source = fs::path(source_name(options.source)).filename().string();
  report.mapping = recorded_name(inputs.tables.file, data_folder);
  gates->judge(report);
  return report;
}

void print_verdict(const QualityReport& report, Console& console, const std::string& file) {
  const std::string name = file.empty() ? file : file + ": ";
  std::string missed;
  long kept = 0, unmeasured = 0;
  for (const GateResult& gate : report.gates) {
    if (!gate.value) {
      ++unmeasured;
    } else if (gate.passed) {
      ++kept;
    } else {
      missed += (missed.empty() ? "" : ", ") + missed_text(gate);
    }
  }
  if (!missed.empty()) console.line("missed", name + missed);
  const auto all = static_cast<long>(report.gates.size());
  std::string text =
      name +
      (all == 0 ? "no gates" : std::to_string(kept) + " of " + count_text(all, "gate") + " kept");
  if (unmeasured > 0) text += ", " + std::to_string(unmeasured) + " not measured";
  // a joint that nothing pushes merely rests there, as fingers do
  const auto limited = std::ranges::find_if(
      report.limited_joints, [](const LimitedJoint& joint) { return !joint.task.empty(); });
  if (limited != report.limited_joints.end()) {
    text += "; " + short_name(limited->joint) + " at its limit in " +
            number_text(limited->frames_pct, 0) + " % of frames";
  }
  console.line("verdict", text);
}

Result<OutputFile> write_run_report(const std::string& path, const QualityReport& report,
                                    Console& console) {
  auto file = OutputFile::create(path);
  if (!file) return file;
  if (auto written = file->write(report_json({&report, 1})); !written) {
    return failure(written.error());
  }
  const auto missed =
      std::ranges::count_if(report.gates, [](const GateResult& gate) { return !gate.passed; });
  console.line("report", path + ": " + count_text(missed, "gate") + " of " +
                             std::to_string(report.gates.size()) + " missed");
  return file;
}

}  // namespace retarget::cli
