#include "retarget/measure_files.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <utility>

#include "app/plan/set_up_robot.h"
#include "app/run/choose_part.h"
#include "base/option_name.h"
#include "base/try.h"
#include "retarget/check_options.h"
#include "retarget/plan.h"
#include "retarget/resample.h"
#include "retarget/solve.h"
#include "retarget/text.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Scales the time of the source as recorded in the sidecar of the motions, unless an option gives
// a factor. Without a record, `auto` is decided again.
Result<void> choose_time_scale(const RecordedMotions& motions, Plan& plan, Observer& observer) {
  if (plan.time_scale || motions.empty()) return {};
  const auto& [file, recorded, part_start] = motions.front();
  if (recorded) plan.time_scale = recorded->time_scale;
  if (plan.time_scale) {
    observer.line("slowed", number_text(plan.time_scale->longer, 2) +
                                " s longer, as the sidecar of " + file + " records it");
    return {};
  }
  // The run found nothing to slow.
  if (recorded && recorded->run.options.solve.time_scale == "auto") return {};
  TRY_ASSIGN(plan, decide_time_scale(std::move(plan)));
  return {};
}

// @param clip  the source if it has been read; empty: a file of the run.
Result<void> add_source(const RecordedMotions& motions, Run run, RunRequest of_source,
                        std::optional<Clip> clip, LoadedRobot robot, Measures& measures,
                        Observer& observer) {
  choose_part(motions, run, of_source, observer);
  TRY_ASSIGN(const RobotSetup setup, set_up_robot(std::move(robot), run.options));
  // Joints that do not follow the human have no range.
  measures.limits = setup.limits;
  auto planned = clip ? plan_clip(*std::move(clip), run, of_source, setup, observer)
                      : read_and_plan(run, of_source, setup, observer);
  TRY_ASSIGN(Plan plan, std::move(planned));
  TRY(choose_time_scale(motions, plan, observer));
  plan.config = measured_config(plan, setup);
  // The method that solved the motion determines the targets of its trunk.
  if (!motions.empty() && motions.front().recorded) {
    plan.options.solve.method = motions.front().recorded->run.options.solve.method;
  }
  TRY_ASSIGN(measures.source, measured_source(std::move(plan)));
  measures.rate = measures.source->rate;
  return {};
}

// Warns of a motion and a source of different lengths.
void warn_of_length(const RobotClip& clip, int source_frames, const RecordedMotion& of,
                    Observer& observer) {
  const std::string& file = of.file;
  const int frames = clip.frame_count();
  const std::string source = "the source has " + count_text(source_frames, "frame");
  const std::string motion = "the motion has " + count_text(frames, "frame");
  if (source_frames < frames) {
    observer.warn({{0, 0,
                    source + " after its start time, " + motion +
                        "; contacts and tracking are measured only up to its end"}},
                  file);
    return;
  }
  if (of.part_start) return;
  // Some formats end one sample before the last frame, and rates differ.
  constexpr double kUsualDifference = 0.1;  // Seconds.
  if (source_frames - frames <= kUsualDifference * clip.rate().fps()) return;
  observer.warn({{0, 0,
                  motion + " of the " + std::to_string(source_frames) +
                      " of the source and is compared with the first ones; " OPTION(
                          "start") " and " OPTION("end") " select another part"}},
                file);
}

MeasuredMotion measure(RobotClip clip, const Measures& measures, const RecordedMotion& of,
                       Observer& observer) {
  const std::string& file = of.file;
  const MeasuredSource* source = measures.source ? &*measures.source : nullptr;
  MotionMeasure measure = measure_motion(clip, measures.limits, source, measures.dynamics);
  if (measure.has_lead_in) {
    observer.line("lead-in", file + " includes the source's leading frames; they are kept");
  }
  if (source != nullptr) warn_of_length(clip, measure.source_frames, of, observer);
  const HumanClip* human = nullptr;
  if (source != nullptr) {
    human = measure.has_lead_in ? &*source->human_with_lead_in : &source->human;
  }
  return {std::move(clip), human, std::move(measure.report), std::nullopt};
}

bool is_same_variant(const RobotChoice& a, const RobotChoice& b) {
  return a.variant == b.variant && a.base == b.base && a.follow == b.follow;
}

// Takes the variant, the base and the part that follows the human from the sidecars of all motions,
// if these agree and the request leaves them open.
RobotChoice recorded_choice(const RecordedMotions& motions, RobotChoice choice) {
  if (motions.empty() || !motions.front().recorded) return choice;
  const RobotChoice& first = motions.front().recorded->run.robot;
  for (const auto& [file, recorded, part_start] : motions) {
    if (!recorded || !is_same_variant(first, recorded->run.robot)) return choice;
  }
  if (choice.variant.empty()) choice.variant = first.variant;
  if (choice.base == RobotBase::kAuto) choice.base = first.base;
  if (choice.follow == Follow::kAll) choice.follow = first.follow;
  return choice;
}

// Loads the scene of motions without a source, whose world is the robot's.
Result<void> add_scene(const SolveOptions& solve, Measures& measures) {
  if (solve.scene.empty() && !solve.object_tracks.empty()) {
    return usage_failure(OPTION("object-track") " requires " OPTION("scene"),
                         "add " OPTION("scene") " FILE with the shape of the object");
  }
  if (solve.scene.empty()) return {};
  TRY_ASSIGN(Scene scene, load_scene(solve.scene));
  for (const std::string& spec : solve.object_tracks) {
    TRY_ASSIGN(ObjectTrack track, load_object_track(spec));
    measures.object_tracks.push_back(std::move(track));
  }
  measures.scene = std::make_shared<const Scene>(std::move(scene));
  return {};
}

// Scales the travel of the source as the sidecars of the motions record it, unless options say how.
void choose_travel(const RecordedMotions& motions, SolveOptions& solve, Observer& observer) {
  if (motions.empty() || solve.purpose || !solve.travel.empty()) return;
  const auto travel_of = [](const RecordedMotion& motion) {
    return motion.recorded ? chosen_travel(motion.recorded->run.options.solve) : std::string();
  };
  const std::string travel = travel_of(motions.front());
  const bool agree = std::ranges::all_of(
      motions, [&](const RecordedMotion& motion) { return travel_of(motion) == travel; });
  if (!agree) {
    observer.warn({{0, 0,
                    "the sidecars of the motions record different travel; the source is used "
                    "unchanged, unless " OPTION("travel") " is given"}},
                  motions.front().file);
    return;
  }
  if (travel.empty()) return;
  solve.travel = travel;
  observer.line("travel", travel + ", as the sidecar records it");
}

// Reads the first motion for its rate, at which the source is planned unless an option gives one.
Result<void> take_rate_of_first(const MeasureRequest& request, Measures& measures, Run& run) {
  if (!request.fps.empty() || run.motion.empty() || request.motions.empty()) return {};
  const std::string& file = request.motions.front();
  TRY_ASSIGN(RobotMotion motion, load_recorded_motion(file, measures.robot, measures.reading));
  run.options.time.fps = motion.clip.rate().fps();
  measures.first = {file, std::make_shared<const RobotMotion>(std::move(motion))};
  return {};
}

Result<RobotMotion> read_motion(const std::string& file, const Measures& measures) {
  if (measures.first.motion && measures.first.file == file) return *measures.first.motion;
  return load_recorded_motion(file, measures.robot, measures.reading);
}

// Measuring against the source needs matching frames.
Result<RobotClip> at_rate_of_source(RobotClip clip, const Measures& measures,
                                    const std::string& file, Observer& observer) {
  if (!measures.source) return clip;
  if (!same_rate(clip.rate(), measures.rate)) {
    observer.line("resampled",
                  file + ": from " + to_text(clip.rate()) + " to " + to_text(measures.rate) +
                      " fps, the rate of the source; gates judge the resampled motion");
  }
  return resample_robot(clip, measures.rate);
}

// The scene of a motion from a file is the given one, scaled.
void warn_of_moved_scene(const RecordedMotions& motions, const SolveOptions& solve,
                         Observer& observer) {
  if (solve.scene.empty() && solve.terrain.empty()) return;
  for (const auto& [file, recorded, part_start] : motions) {
    if (!recorded) continue;
    const Options& options = recorded->run.options;
    const bool is_fitted = options.solve.object_motion == ObjectMotion::kFitted;
    if (!is_fitted && !options.save.normalize_start) continue;
    const std::string move = options.save.normalize_start ? OPTION("normalize-start")
                                                          : OPTION("object-motion") " fitted";
    observer.warn(
        {{0, 0,
          "the sidecar records " + move +
              ", but the scene or terrain is measured at its original position; the report "
              "of the run has the correct metrics"}},
        file);
  }
}

}  // namespace

Result<Measures> load_measures(const MeasureRequest& request, Observer& observer) {
  Run run = request.run;
  if (!request.fps.empty()) {
    auto rate = rate_from_text(request.fps);
    if (!rate) return usage_failure(OPTION("fps") ": " + rate.error().message);
    run.options.time.fps = *rate;
  }
  Measures measures;
  TRY_ASSIGN(const std::string data_folder, find_data_folder(request.data_folder));
  TRY_ASSIGN(measures.gates, changed_gates(request.gates, data_folder));
  measures.dynamics = request.dynamics || measures.gates.need_dynamics();
  TRY_ASSIGN(LoadedRobot robot, load_robot(run.robot, request.data_folder, observer));
  const RecordedMotions motions = recorded_motions(request.motions);
  RobotChoice choice = recorded_choice(motions, run.robot);
  const auto& variants = robot.robot->profile().variants;
  // The robot given may not be the recorded one.
  if (std::ranges::find(variants, choice.variant, &RobotVariant::name) == variants.end()) {
    choice.variant = run.robot.variant;
  }
  if (!is_same_variant(choice, run.robot)) {
    run.robot = std::move(choice);
    TRY_ASSIGN(robot, load_robot(run.robot, request.data_folder, observer));
  }
  measures.robot = robot.robot;
  measures.model = robot.model;
  std::string& limits = run.options.solve.limits;
  if (limits.empty()) limits = measures.robot->limits_for({});
  TRY_ASSIGN(measures.limits, load_limits(*measures.robot, limits));
  measures.reading =
      read_motion_options(request.reading, memory_share(run.options.source.memory_gb));
  TRY(take_rate_of_first(request, measures, run));
  if (run.options.time.fps) measures.rate = frame_rate_from_fps(*run.options.time.fps);
  if (!run.motion.empty()) {
    choose_travel(motions, run.options.solve, observer);
    warn_of_moved_scene(motions, run.options.solve, observer);
    TRY(add_source(motions, run, request.of_source, std::nullopt, std::move(robot), measures,
                   observer));
  } else {
    TRY(add_scene(run.options.solve, measures));
    if (run.options.source.source_fps > 0.0) {
      measures.reading.rate = frame_rate_from_fps(run.options.source.source_fps);
    }
  }
  if (!request.fps.empty()) measures.reading.default_rate = measures.rate;
  return measures;
}

Result<MeasuredMotion> measure_file(const std::string& file, const Measures& measures,
                                    Observer& observer) {
  TRY_ASSIGN(RobotMotion motion, read_motion(file, measures));
  // A rate given by the user is not a guess.
  const bool rate_known = motion.rate_known;
  motion.rate_known = rate_known || measures.reading.default_rate.has_value();
  report_reading(file, motion, observer, OPTION("fps"));
  if (rate_known && measures.reading.default_rate && !measures.source &&
      !same_rate(*measures.reading.default_rate, motion.clip.rate())) {
    observer.warn(
        {{0, 0,
          "the file gives " + to_text(motion.clip.rate()) +
              " fps, which is used; " OPTION("fps") " applies only to files without a "
                                                    "rate, " OPTION("source-fps") " to all files"}},
        file);
  }
  const FrameRate file_rate = motion.clip.rate();
  TRY_ASSIGN(RobotClip clip, at_rate_of_source(std::move(motion.clip), measures, file, observer));
  const auto start = std::chrono::steady_clock::now();
  MeasuredMotion measured = measure(std::move(clip), measures, {file, std::nullopt}, observer);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  if (measures.source && !same_rate(file_rate, measures.rate)) measured.file_rate = file_rate;
  QualityReport& report = measured.report;
  report.file = file == "-" ? "-" : fs::path(file).filename().string();
  measures.gates.judge(report);
  observer.line("measured", report.file + ": " + count_text(report.frames, "frame") + " in " +
                                number_text(time.count(), 2) + " s");
  return measured;
}

Result<MotionBeside> measure_against(const RobotClip& motion, const RecordedMotion& record,
                                     Clip source, LoadedRobot robot, const Options& options,
                                     bool dynamics, Observer& observer) {
  Run run{.motion = source.name(), .robot = robot.choice, .options = options, .output = {}};
  std::string& limits = run.options.solve.limits;
  if (limits.empty()) limits = robot.robot->limits_for({});
  Measures measures;
  measures.dynamics = dynamics;
  const RecordedMotions motions = {record};
  choose_travel(motions, run.options.solve, observer);
  warn_of_moved_scene(motions, run.options.solve, observer);
  TRY(add_source(motions, run, {}, std::move(source), std::move(robot), measures, observer));
  if (record.part_start) {
    const double frames = std::round(*record.part_start * measures.rate.fps());
    skip_frames(*measures.source, static_cast<int>(std::clamp(frames, 0.0, 1e9)));
  }
  TRY_ASSIGN(RobotClip clip, at_rate_of_source(motion, measures, record.file, observer));
  MeasuredMotion measured = measure(std::move(clip), measures, record, observer);
  return MotionBeside{*measured.human, std::move(measured.report)};
}

Result<std::shared_ptr<const MotionScene>> measured_scene(const MeasuredMotion& motion,
                                                          const Measures& measures) {
  std::optional<MotionScene> scene;
  if (measures.source) {
    const auto& with_lead_in = measures.source->human_with_lead_in;
    const bool lead_in = with_lead_in && motion.human == &*with_lead_in;
    TRY_ASSIGN(scene, motion_scene(*measures.source, lead_in, *measures.robot));
  } else if (measures.scene) {
    const FrameRate& rate = motion.clip.rate();
    const int frames = motion.clip.frame_count();
    scene.emplace();
    TRY_ASSIGN(scene->robot, place_scene(measures.scene, measures.object_tracks,
                                         {rate, frames, 0, rate, frames}));
  }
  if (!scene) return std::shared_ptr<const MotionScene>();
  return std::make_shared<const MotionScene>(std::move(*scene));
}

}  // namespace retarget
