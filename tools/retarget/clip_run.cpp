#include "clip_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "csv_sink.h"
#include "fit_run.h"
#include "interrupt.h"
#include "limit_lines.h"
#include "retarget/base/suggest.h"
#include "retarget/pipeline/retarget.h"
#include "retarget/robot/limit_distance.h"
#include "run_report.h"
#include "run_setup.h"

namespace retarget::cli {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

RobotCsvOptions csv_options(const RunOptions& options) {
  RobotCsvOptions csv;
  csv.precision = options.precision;
  csv.delimiter = options.delimiter == "comma" ? ',' : options.delimiter == "space" ? ' ' : '\t';
  csv.header = options.header;
  csv.quaternion_order =
      options.quaternion == "wxyz" ? QuaternionOrder::kWxyz : QuaternionOrder::kXyzw;
  return csv;
}

void print_limits(const RobotClip& clip, const LimitSet& limits, Console& console) {
  const auto nearest = nearest_limit(clip, limits);
  if (!nearest) return;
  // what rounds to nothing in the file is neither before the limit nor beyond it
  constexpr double kNothing = 5e-7;
  const std::string side = nearest->at_upper ? "upper limit" : "lower limit";
  const std::string distance = number_text(std::abs(nearest->distance), 6);
  const std::string where = std::abs(nearest->distance) < kNothing ? " is at its " + side
                            : nearest->distance > 0.0
                                ? " comes nearest, " + distance + " from its " + side
                                : " goes " + distance + " beyond its " + side;
  console.line("limits", limits.name + ": " + nearest->joint + where + " in frame " +
                             std::to_string(nearest->frame) + "; joints at a limit in " +
                             number_text(100.0 * nearest->frames_at_limit, 1) + " % of frames");
}

// of a partial body: rows of bones that it lacks
void leave_out_missing(const HumanSource& human, IkTables& tables, Console& console) {
  std::vector<std::string> missing;
  for (int bone = 0; bone < kBoneCount; ++bone) {
    const auto& source = human.calibration.mapping.bones[static_cast<std::size_t>(bone)];
    if (source.position_joint < 0) missing.emplace_back(kBoneNames[bone]);
  }
  const int dropped = leave_out_bones(tables, missing);
  if (dropped == 0) return;
  console.line("partial", count_text(dropped, "row") +
                              " of the mapping left out, for there is no " + list_names(missing));
}

Result<RetargetResult> solve(const Source& source, const RobotSetup& setup,
                             const RunOptions& options, CsvSink& sink, Console& console) {
  RetargetOptions retarget_options;
  retarget_options.engine = options.engine == "reference" ? IkEngine::kReference : IkEngine::kFast;
  retarget_options.targets_ahead = true;
  retarget_options.height_scale = choose_scale(source.human, *setup.robot, setup.tables, options);
  retarget_options.keep_going = [&](int frame) {
    console.progress("solving frame", frame, source.clip.frame_count());
    return !InterruptGuard::interrupted();
  };
  if (options.method == "fit") {
    auto fitted = run_fit(source.clip, source.human, setup.robot, setup.tables, setup.limits,
                          options, retarget_options, console);
    if (!fitted) return failure(fitted.error());
    for (int frame = 0; frame < fitted->clip.frame_count(); ++frame) {
      sink.add(fitted->clip.qpos(frame));
    }
    RetargetResult result;
    result.steps = fitted->steps;
    result.clip = std::move(fitted->clip);
    return result;
  }
  retarget_options.frame_solved = [&](int, std::span<const double> qpos) { sink.add(qpos); };
  auto result =
      retarget::retarget(source.clip, source.human.calibration.mapping, source_name(options.source),
                         setup.robot, setup.tables, setup.limits, retarget_options);
  console.end_progress();
  return result;
}

}  // namespace

Result<RobotSetup> load_robot_setup(const RunOptions& options,
                                    const std::filesystem::path& data_folder, Console& console) {
  const auto chosen = load_chosen_robot(options, data_folder, console);
  if (!chosen) return failure(chosen.error());
  RobotSetup setup;
  setup.robot = chosen->robot;
  // the published method judges by its own, tighter set where the robot has one
  auto limits =
      load_limits(*setup.robot, options.limits.empty() ? setup.robot->limits_for(options.method)
                                                       : options.limits);
  if (!limits) return failure(limits.error());
  setup.limits = std::move(*limits);
  auto tables = load_mapping(options, *chosen, data_folder);
  if (!tables) return failure(tables.error());
  setup.tables = std::move(*tables);
  return setup;
}

Result<void> run_clip(const RunOptions& options, const RobotSetup& setup,
                      const std::filesystem::path& data_folder, Console& console) {
  const auto start = std::chrono::steady_clock::now();
  const auto source = load_source(options, data_folder, console);
  if (!source) return failure(source.error());
  IkTables tables = setup.tables;
  if (source->human.map.partial) leave_out_missing(source->human, tables, console);
  const RobotSetup of_clip{setup.robot, setup.limits, std::move(tables)};
  console.line("robot",
               setup.robot->name() + ", " +
                   count_text(static_cast<long>(setup.robot->output_joints().size()), "joint") +
                   ", limits " + setup.limits.name + ", mapping " + setup.tables.file);

  // from here on Ctrl-C stops between two frames and leaves nothing behind
  const InterruptGuard guard;
  auto sink =
      CsvSink::open(options.output, of_clip.robot, {csv_options(options), options.normalize_start});
  if (!sink) return failure(sink.error());
  const auto result = solve(*source, of_clip, options, **sink, console);
  if (!result) return failure(result.error());
  const RobotClip& motion = result->clip;
  console.line("solved",
               count_text(motion.frame_count(), "frame") + " at " + to_text(motion.rate()) +
                   " fps, " +
                   number_text(static_cast<double>(result->steps) / motion.frame_count(), 2) +
                   " IK steps a frame");
  print_limits(motion, of_clip.limits, console);
  const auto at_limits =
      joints_at_limits(motion, source->clip, source->human.calibration.mapping, of_clip.tables,
                       choose_scale(source->human, *of_clip.robot, of_clip.tables, options),
                       of_clip.limits, kNamedAtLimit);
  print_joints_at_limits(at_limits, *of_clip.robot, of_clip.limits, console);
  if (InterruptGuard::interrupted()) return interrupted_failure();
  if (auto written = (*sink)->finish(); !written) return written;
  if (!options.report.empty()) {
    const RunReportInputs inputs{motion, *source, of_clip.tables, of_clip.limits,
                                 csv_options(options)};
    if (auto written = write_run_report(options, inputs, data_folder, console); !written) {
      return written;
    }
  }
  console.line("wrote", (options.output == "-" ? "standard output" : options.output) + " in " +
                            number_text(seconds_since(start), 2) + " s");
  return {};
}

}  // namespace retarget::cli
