#include "measure_files.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "read_motion.h"
#include "retarget/check_options.h"
#include "retarget/measure.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "robot/model/resample_robot.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

Result<void> add_source(const RunArguments& arguments, LoadedRobot robot, Measures& measures,
                        Console& console) {
  const Run& run = arguments.run;
  RETARGET_TRY_ASSIGN(const RobotSetup setup,
                      retarget::set_up_robot(std::move(robot), run.options));
  RETARGET_TRY_ASSIGN(Plan plan, read_and_plan(run, arguments.request, setup, console));
  // Restores the tasks of bones that the human lacks, which the plan leaves out: they are measured
  // as well.
  plan.config = setup.config_for(plan.human);
  RETARGET_TRY_ASSIGN(measures.source, measured_source(std::move(plan)));
  measures.rate = measures.source->rate;
  return {};
}

MeasuredMotion measure(RobotClip clip, const Measures& measures, const std::string& file,
                       Console& console) {
  const MeasuredSource* source = measures.source ? &*measures.source : nullptr;
  MotionMeasure measure = measure_motion(clip, measures.limits, source);
  if (measures.dynamics) add_dynamics(clip, measure.report);
  if (measure.has_lead_in) {
    console.line("lead-in", file + " includes the source's leading frames; they are kept");
  }
  if (source != nullptr && measure.source_frames < clip.frame_count()) {
    console.warn(
        {{0, 0,
          "the source has " + count_text(measure.source_frames, "frame") +
              " after its start time, the motion has " + count_text(clip.frame_count(), "frame") +
              "; contacts and tracking are measured only up to its end"}},
        file);
  }
  const HumanClip* human = nullptr;
  if (source != nullptr) {
    human = measure.has_lead_in ? &*source->human_with_lead_in : &source->human;
  }
  return {std::move(clip), human, std::move(measure.report), std::nullopt};
}

// Returns the variant that all motions were made for, according to their sidecars; empty for the
// whole robot or several variants.
std::string variant_of(const std::vector<std::string>& motions) {
  std::string common;
  for (const std::string& motion : motions) {
    const std::string variant = recorded_variant(motion);
    if (variant.empty() || (!common.empty() && variant != common)) return {};
    common = variant;
  }
  return common;
}

}  // namespace

Result<std::vector<std::string>> check_inputs(const MeasureArguments& arguments) {
  const Run& run = arguments.run.run;
  const bool source = !run.motion.empty() || !arguments.run.smpl_file.empty();
  if (!source && (run.options.part.start_s >= 0.0 || arguments.fps == "source")) {
    return usage_failure(
        std::string(arguments.fps == "source" ? "--fps source" : "--start") + " needs the source",
        "add --bvh FILE");
  }
  const auto inputs = std::ranges::count(arguments.motions, "-") + (run.motion == "-" ? 1 : 0);
  if (inputs > 1) return usage_failure("standard input can be read only once");
  std::vector<std::string> read = files_read(run, arguments.run.common);
  read.insert(read.end(), arguments.motions.begin(), arguments.motions.end());
  read.insert(read.end(), arguments.gates.begin(), arguments.gates.end());
  read.push_back(arguments.run.smpl_file);
  return read;
}

Result<Measures> load_measures(const MeasureArguments& arguments, Console& console,
                               const std::optional<FrameRate>& source_rate) {
  RunArguments with_file = arguments.run;
  RETARGET_TRY(take_smpl_file(with_file));
  Run& run = with_file.run;
  if (!arguments.fps.empty()) {
    RETARGET_TRY_ASSIGN(run.options.time.fps, rate_of(arguments.fps));
  } else if (source_rate) {
    run.options.time.fps = source_rate->fps();
  }
  Measures measures;
  measures.dynamics = arguments.dynamics;
  RETARGET_TRY_ASSIGN(const std::string data_folder, data_folder_of(with_file.common));
  RETARGET_TRY_ASSIGN(measures.gates, changed_gates(arguments.gates, data_folder));
  const std::string variant = run.robot.variant.empty() ? variant_of(arguments.motions) : "";
  RETARGET_TRY_ASSIGN(LoadedRobot robot, load_robot(run.robot, with_file.common, console));
  const auto& variants = robot.robot->profile().variants;
  if (std::ranges::find(variants, variant, &RobotVariant::name) != variants.end()) {
    run.robot.variant = variant;
    RETARGET_TRY_ASSIGN(robot, load_robot(run.robot, with_file.common, console));
  }
  measures.robot = robot.robot;
  measures.model = robot.model;
  std::string& limits = run.options.solve.limits;
  if (limits.empty()) limits = measures.robot->limits_for({});
  RETARGET_TRY_ASSIGN(measures.limits, load_limits(*measures.robot, limits));
  if (run.options.time.fps) measures.rate = frame_rate_from_fps(*run.options.time.fps);
  measures.reading = read_motion_options(arguments.reading, run.options.source.memory_gb);
  if (!run.motion.empty()) {
    RETARGET_TRY(add_source(with_file, std::move(robot), measures, console));
  } else if (run.options.source.source_fps > 0.0) {
    measures.reading.rate = frame_rate_from_fps(run.options.source.source_fps);
  }
  if (!arguments.fps.empty()) measures.reading.default_rate = measures.rate;
  return measures;
}

Result<MeasuredMotion> measure_file(const std::string& file, const Measures& measures,
                                    Console& console) {
  RETARGET_TRY_ASSIGN(RobotMotion motion,
                      load_recorded_motion(file, measures.robot, measures.reading));
  // A rate given by --fps is not a guess.
  const bool rate_known = motion.rate_known;
  motion.rate_known = rate_known || measures.reading.default_rate.has_value();
  print_motion(file, motion, console, "--fps");
  if (rate_known && measures.reading.default_rate && !measures.source &&
      !same_rate(*measures.reading.default_rate, motion.clip.rate())) {
    console.warn({{0, 0,
                   "the file gives " + to_text(motion.clip.rate()) +
                       " fps, which is used; --fps applies only to files without a rate, "
                       "--source-fps to all files"}},
                 file);
  }
  // Measuring against the source needs matching frames.
  const FrameRate file_rate = motion.clip.rate();
  RobotClip clip = std::move(motion.clip);
  if (measures.source) {
    RETARGET_TRY_ASSIGN(clip, resample_robot(clip, measures.rate));
  }
  const auto start = std::chrono::steady_clock::now();
  MeasuredMotion measured = measure(std::move(clip), measures, file, console);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  if (measures.source && !same_rate(file_rate, measures.rate)) measured.file_rate = file_rate;
  QualityReport& report = measured.report;
  report.file = file == "-" ? "-" : fs::path(file).filename().string();
  measures.gates.judge(report);
  console.line("measured", report.file + ": " + count_text(report.frames, "frame") + " in " +
                               number_text(time.count(), 2) + " s");
  return measured;
}

}  // namespace retarget::cli
