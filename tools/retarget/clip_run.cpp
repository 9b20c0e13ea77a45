#include "clip_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/suggest.h"
#include "base/try.h"
#include "fit_run.h"
#include "format_losses.h"
#include "interrupt.h"
#include "limit_lines.h"
#include "pipeline/retarget.h"
#include "robot/limit_distance.h"
#include "run_report.h"
#include "run_setup.h"
#include "sidecar.h"

namespace retarget::cli {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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
Result<void> leave_out_missing(const HumanSource& human, ResolvedMapping& tables,
                               Console& console) {
  std::vector<Bone> missing;
  std::vector<std::string> names;
  for (const Bone bone : kAllBones) {
    if (human.calibration.mapping.bones[bone].position_joint >= 0) continue;
    missing.push_back(bone);
    names.emplace_back(bone_name(bone));
  }
  TRY_ASSIGN(const int dropped, leave_out_bones(tables, missing));
  if (dropped == 0) return {};
  console.line("partial", count_text(dropped, "row") +
                              " of the mapping left out, for there is no " + list_names(names));
  return {};
}

// the robot, and by which of its mappings
void print_robot(const ClipSetup& of_clip, const RobotSetup& setup, Console& console) {
  const std::string& mapping = of_clip.tables.file;
  const auto joints = static_cast<long>(setup.robot->output_joints().size());
  console.line("robot", setup.robot->name() + ", " + count_text(joints, "joint") + ", limits " +
                            setup.limits.name + ", mapping " + mapping);
  if (setup.mappings.of_others && mapping == setup.mappings.of_others->file) {
    console.line("",
                 "the derived mapping, for the source is not LAFAN1; --ik-config published "
                 "takes the published one");
  }
}

// a motion, and what a fit found
struct Solved {
  RobotClip clip;
  long steps = 0;
  std::optional<FitReport> fit;
};

Result<Solved> solve(const Source& source, const ClipSetup& setup, const RunOptions& options,
                     MotionOutputs& outputs, Console& console) {
  RetargetOptions retarget_options;
  retarget_options.engine = options.engine == "reference" ? IkEngine::kReference : IkEngine::kFast;
  retarget_options.targets_ahead = options.threads != 1;
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
      outputs.add(fitted->clip.qpos(frame));
    }
    return Solved{std::move(fitted->clip), fitted->steps, std::move(fitted->report)};
  }
  retarget_options.frame_solved = [&](int, std::span<const double> qpos) { outputs.add(qpos); };
  auto result =
      retarget::retarget(source.clip, source.human.calibration.mapping, source_name(options.source),
                         setup.robot, setup.tables, setup.limits, retarget_options);
  console.end_progress();
  if (!result) return failure(result.error());
  return Solved{std::move(result->clip), result->steps, std::nullopt};
}

// joints that stay at a limit, and why
void print_joints(const RobotClip& motion, const Source& source, const ClipSetup& setup,
                  const RunOptions& options, Console& console) {
  const auto at_limits = joints_at_limits(
      motion, source.clip, source.human.calibration.mapping, setup.tables,
      choose_scale(source.human, *setup.robot, setup.tables, options),
      options.method == "gmr" ? TrunkRule::kBones : TrunkRule::kLines, setup.limits, kNamedAtLimit);
  print_joints_at_limits(at_limits, *setup.robot, setup.limits, console);
}

// the motion's files, their sidecars, the report
Result<ClipOutcome> write_results(const RunOptions& options, const ClipSetup& setup,
                                  const Source& source, const Solved& solved,
                                  const std::filesystem::path& data_folder, MotionOutputs& outputs,
                                  Console& console) {
  const RobotClip& motion = solved.clip;
  ClipOutcome outcome;
  outcome.frames = motion.frame_count();
  outcome.fps = motion.rate().fps();
  outcome.mapping = setup.tables.file;
  // who reads the summary is told its verdict, which must not make a run fail
  const bool asked = options.measure || options.sidecar || !options.report.empty();
  if (asked || console.is_read()) {
    const auto write = write_options(options);
    if (!write) return failure(write.error());
    const RunReportInputs inputs{motion, source, setup.tables, setup.limits, write->csv};
    auto measured = measure_run(options, inputs, data_folder);
    if (!measured && asked) return failure(measured.error());
    if (measured) {
      outcome.quality = std::move(*measured);
      outcome.quality->fit = solved.fit;
    }
  }
  SidecarText sidecar;
  if (options.sidecar) {
    auto read = files_read(options, data_folder, setup.tables.file);
    if (!read) return failure(read.error());
    sidecar = [&, read = std::move(*read)](const WrittenFile& file) {
      return sidecar_text(options, setup, source, file, *outcome.quality, read);
    };
  }
  // complete before the motion's files appear
  std::optional<OutputFile> report;
  if (!options.report.empty()) {
    auto written = write_run_report(options.report, *outcome.quality, console);
    if (!written) return failure(written.error());
    report = std::move(*written);
    outcome.others.push_back(options.report);
  }
  auto files = outputs.finish(motion, sidecar);
  if (!files) return failure(files.error());
  outcome.motions = std::move(*files);
  if (options.sidecar) {
    for (const WrittenFile& file : outcome.motions) {
      outcome.others.push_back(file.item.path + ".json");
    }
  }
  if (report) {
    if (auto done = report->commit(); !done) return failure(done.error());
  }
  return outcome;
}

}  // namespace

Result<void> check_solving_options(const RunOptions& options) {
  if (auto robot = check_robot_choice(options); !robot) return robot;
  if (!options.robot_xml.empty() && options.ik_config.empty()) {
    return usage_failure("--robot-xml comes without a mapping",
                         "add --ik-config FILE, or make a robot of the model: retarget robots "
                         "add NAME --model FILE");
  }
  if (options.method != "fit" &&
      (!options.fit_config.empty() || !options.without.empty() || options.fit_window_s > 0.0)) {
    return usage_failure("--fit-config, --without and --window belong to --method fit",
                         "leave out --method");
  }
  if (!options.frames.empty() && (options.start_s >= 0.0 || options.end_s >= 0.0)) {
    return usage_failure("--frames and --start/--end both choose a part of the clip",
                         "give one of them");
  }
  return {};
}

Result<RobotSetup> load_robot_setup(const RunOptions& options,
                                    const std::filesystem::path& data_folder, Console& console) {
  const auto chosen = load_chosen_robot(options, data_folder, console, Soles::kNeeded);
  if (!chosen) return failure(chosen.error());
  RobotSetup setup;
  setup.robot = chosen->robot;
  // the published method judges by its own, tighter set where the robot has one
  auto limits =
      load_limits(*setup.robot, options.limits.empty() ? setup.robot->limits_for(options.method)
                                                       : options.limits);
  if (!limits) return failure(limits.error());
  setup.limits = std::move(*limits);
  auto mappings = load_mappings(options, *chosen, data_folder);
  if (!mappings) return failure(mappings.error());
  setup.mappings = std::move(*mappings);
  return setup;
}

Result<ClipOutcome> run_clip(const RunOptions& options, const RobotSetup& setup,
                             const std::filesystem::path& data_folder, Console& console,
                             Writing writing) {
  const auto start = std::chrono::steady_clock::now();
  const auto source = load_source(options, data_folder, console);
  if (!source) return failure(source.error());
  ClipSetup of_clip{setup.robot, setup.limits, setup.mappings.for_source(source->human)};
  if (source->human.map.partial) TRY(leave_out_missing(source->human, of_clip.tables, console));
  print_robot(of_clip, setup, console);

  // from here on Ctrl-C stops between two frames and leaves nothing behind
  const InterruptGuard guard;
  auto outputs =
      MotionOutputs::open(options, of_clip.robot, source->clip.rate(), writing == Writing::kHashes);
  if (!outputs) return failure(outputs.error());
  const auto result = solve(*source, of_clip, options, **outputs, console);
  if (!result) return failure(result.error());
  const RobotClip& motion = result->clip;
  console.line("solved",
               count_text(motion.frame_count(), "frame") + " at " + to_text(motion.rate()) +
                   " fps, " +
                   number_text(static_cast<double>(result->steps) / motion.frame_count(), 2) +
                   " IK steps a frame");
  print_limits(motion, of_clip.limits, console);
  if (console.is_read()) print_joints(motion, *source, of_clip, options, console);
  if (InterruptGuard::interrupted()) return interrupted_failure();
  auto outcome = write_results(options, of_clip, *source, *result, data_folder, **outputs, console);
  if (!outcome || writing == Writing::kHashes) return outcome;
  warn_of_losses(options, motion, console);
  console.line("wrote", outputs_text(outcome->motions) + " in " +
                            number_text(seconds_since(start), 2) + " s");
  if (outcome->quality) print_verdict(*outcome->quality, console);
  return outcome;
}

}  // namespace retarget::cli
