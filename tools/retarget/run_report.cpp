#include "run_report.h"

#include <algorithm>

#include "read_source.h"
#include "retarget/base/file.h"
#include "retarget/quality/measure.h"
#include "retarget/robot/normalize_start.h"
#include "robot_mapping.h"

namespace retarget::cli {

namespace fs = std::filesystem;

Result<Gates> default_gates(const fs::path& data_folder) {
  Gates gates;
  const fs::path file = data_folder / "configs" / "quality" / "default.json";
  if (auto added = gates.add_file(file.string()); !added) return failure(added.error());
  return gates;
}

Result<QualityReport> measure_run(const RunOptions& options, const RunReportInputs& inputs,
                                  const fs::path& data_folder) {
  const auto gates = default_gates(data_folder);
  if (!gates) return failure(gates.error());
  // what counts is what was printed, digits cut off and all
  RobotClip moved = inputs.motion;
  if (options.normalize_start) normalize_start(moved);
  auto printed = printed_clip(moved, inputs.csv.precision);
  if (!printed) {
    printed.error().file = options.output;
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
