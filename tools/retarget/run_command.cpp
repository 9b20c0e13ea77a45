// The default command: one motion file to one robot CSV.

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>

#include "commands.h"
#include "csv_sink.h"
#include "fit_run.h"
#include "human_source.h"
#include "interrupt.h"
#include "retarget/base/data_folder.h"
#include "retarget/base/file.h"
#include "retarget/base/suggest.h"
#include "retarget/motion/clip_range.h"
#include "retarget/motion/resample.h"
#include "retarget/pipeline/retarget.h"
#include "retarget/robot/limit_distance.h"
#include "retarget/robot/load_robot.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

// everything that is loaded before the first frame is solved
struct Setup {
  std::shared_ptr<const Robot> robot;
  LimitSet limits;
  IkTables tables;
};

// the motion as it is solved
struct Source {
  Clip clip;  // cut and at the output rate
  HumanSource human;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Result<void> check_usage(const RunOptions& options) {
  if (options.source.file.empty()) {
    return usage_failure("no motion file is given",
                         "retarget --bvh walk.bvh --robot unitree_g1 "
                         "-o walk.csv; retarget --help shows more");
  }
  if (options.robot.empty() && options.robot_xml.empty()) {
    return usage_failure("no robot is given", "add --robot NAME or --robot-xml FILE");
  }
  if (!options.robot.empty() && !options.robot_xml.empty()) {
    return usage_failure("--robot and --robot-xml both name a robot", "give one of them");
  }
  if (!options.robot_profile.empty() && options.robot_xml.empty()) {
    return usage_failure("--robot-profile belongs to --robot-xml", "add --robot-xml FILE");
  }
  if (!options.robot_xml.empty() && options.ik_config.empty()) {
    return usage_failure("--robot-xml comes without a mapping", "add --ik-config FILE");
  }
  if (options.output.empty()) {
    return usage_failure("no output is given", "add -o FILE, or -o - for standard output");
  }
  if (options.method != "fit" && (!options.fit_config.empty() || !options.without.empty())) {
    return usage_failure("--fit-config and --without belong to --method fit", "add --method fit");
  }
  if (!options.frames.empty() && (options.start_s >= 0.0 || options.end_s >= 0.0)) {
    return usage_failure("--frames and --start/--end both choose a part of the clip",
                         "give one of them");
  }
  for (const std::string_view end : {".npz", ".pkl"}) {
    if (options.output.ends_with(end)) {
      return usage_failure(
          "the output \"" + options.output + "\" is no CSV: CSV is what is written",
          "give a name that ends in .csv");
    }
  }
  std::error_code ignored;
  if (options.output != "-" && fs::equivalent(options.source.file, options.output, ignored)) {
    return usage_failure("the output would overwrite the input \"" + options.source.file + "\"",
                         "give another name with -o");
  }
  return check_output_folder(options.output);
}

// the output rate; nothing: the source's own
Result<std::optional<FrameRate>> output_rate(const std::string& text) {
  if (text == "source") return std::optional<FrameRate>();
  double fps = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), fps);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  // wider than any motion, narrower than any slip
  if (!whole || !(fps >= 0.001 && fps <= 1e6)) {
    return usage_failure("--fps must be a number from 0.001 to 1000000 or `source`, found \"" +
                         text + "\"");
  }
  return frame_rate_from_fps(fps);
}

// the part of the clip that the user asked for
Result<Clip> choose_frames(Clip clip, const RunOptions& options) {
  if (options.frames.empty() && options.start_s < 0.0 && options.end_s < 0.0) return clip;
  const auto given = [](double seconds) {
    return seconds < 0.0 ? std::nullopt : std::optional<double>(seconds);
  };
  const auto range = options.frames.empty()
                         ? frame_range_from_seconds(given(options.start_s), given(options.end_s),
                                                    clip.rate(), clip.frame_count())
                         : frame_range_from_text(options.frames, clip.frame_count());
  if (!range) return failure(range.error());
  return cut(clip, range->begin, range->end);
}

// the clip, cut and at the output rate
Result<Clip> prepare_clip(Clip clip, const RunOptions& options) {
  const auto rate = output_rate(options.fps);
  if (!rate) return failure(rate.error());
  auto chosen = choose_frames(std::move(clip), options);
  if (!chosen || !*rate) return chosen;
  ResampleOptions resample_options;
  resample_options.interpolation =
      options.interpolation == "linear" ? Interpolation::kLinear : Interpolation::kCubic;
  resample_options.antialias = !options.no_antialias;
  auto resampled = resample(std::move(*chosen), **rate, resample_options);
  if (!resampled) resampled.error().file = source_name(options.source);
  return resampled;
}

// the motion file and the human in it
Result<Source> load_source(const RunOptions& options, const fs::path& data_folder,
                           Console& console) {
  auto motion = read_source(options.source, false, console);
  if (!motion) return failure(motion.error());
  const Clip& clip = motion->clip;
  console.line("read", source_name(options.source) + ": " +
                           count_text(clip.skeleton().joint_count(), "joint") + ", " +
                           count_text(clip.frame_count(), "frame") + " at " + to_text(clip.rate()) +
                           " fps, " + number_text(clip.duration(), 2) + " s");
  if (clip.frame_count() == 0) {
    return input_failure(source_name(options.source), "the clip has no frames to retarget",
                         "retarget inspect shows its skeleton");
  }
  // rest pose, unit and axes are looked for in the whole clip, whatever part is taken
  auto human =
      find_human(*motion, options.source, options.human, data_folder / "configs" / "skeletons");
  if (!human) return failure(human.error());
  console.line("taken as", human->calibration.mapping.description);
  for (const std::string& note : human->map.notes) console.line("", note);
  console.warn(human->calibration.mapping.doubts, source_name(options.source));
  auto prepared = prepare_clip(std::move(motion->clip), options);
  if (!prepared) return failure(prepared.error());
  return Source{std::move(*prepared), std::move(*human)};
}

// the mapping that comes with a robot: in its folder, or among the mappings by its name
Result<std::string> find_mapping(const fs::path& robot_folder, const fs::path& configs,
                                 const std::string& robot) {
  const fs::path own = robot_folder / "ik.json";
  const fs::path shared = configs / ("lafan1_to_" + robot + ".json");
  std::error_code ignored;
  for (const fs::path& path : {own, shared}) {
    if (fs::is_regular_file(path, ignored)) return path.string();
  }
  return config_failure("",
                        "there is no mapping for the robot \"" + robot + "\": neither " +
                            own.string() + " nor " + shared.string(),
                        "add --ik-config FILE");
}

Result<fs::path> data_folder_of(const RunOptions& options) {
  const auto& chosen = options.common.data_dir;
  return find_data_folder(chosen.empty() ? std::nullopt : std::optional<std::string>(chosen));
}

Result<Setup> load_setup(const RunOptions& options, const fs::path& data_folder, Console& console) {
  Setup setup;
  std::string model = options.robot_xml, profile = options.robot_profile;
  std::string mapping = options.ik_config;
  if (model.empty()) {
    const auto found = find_robot(options.robot, data_folder / "robots");
    if (!found) return failure(found.error());
    model = found->model.string();
    profile = found->profile.string();
  }
  auto robot = load_robot(model, profile);
  if (!robot) return failure(robot.error());
  setup.robot = *robot;
  for (const std::string& warning : setup.robot->warnings()) {
    console.warn({{0, 0, warning}}, model);
  }
  if (mapping.empty()) {
    const auto found = find_mapping(fs::path(model).parent_path(), data_folder / "configs",
                                    fs::path(setup.robot->name()).filename().string());
    if (!found) return failure(found.error());
    mapping = *found;
  }
  // the published method judges by its own, tighter set where the robot has one
  auto limits =
      load_limits(*setup.robot, options.limits.empty() ? setup.robot->limits_for(options.method)
                                                       : options.limits);
  if (!limits) return failure(limits.error());
  setup.limits = std::move(*limits);
  auto tables = load_ik_tables(mapping, setup.robot.get());
  if (!tables) return failure(tables.error());
  setup.tables = std::move(*tables);
  return setup;
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

Result<RetargetResult> solve(const Source& source, const Setup& setup, const RunOptions& options,
                             CsvSink& sink, Console& console) {
  RetargetOptions retarget_options;
  retarget_options.engine = options.engine == "reference" ? IkEngine::kReference : IkEngine::kFast;
  retarget_options.targets_ahead = true;
  // the published method takes every body of LAFAN1 for one
  const bool published = source.human.calibration.rest_pose == "lafan1";
  if (options.scale == "height" || (options.scale == "auto" && !published)) {
    retarget_options.height_scale = HeightScale::kNormalised;
  }
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

Result<void> run_checked(const RunOptions& options, Console& console) {
  const auto start = std::chrono::steady_clock::now();
  if (auto usage = check_usage(options); !usage) return usage;
  const auto data_folder = data_folder_of(options);
  if (!data_folder) return failure(data_folder.error());
  auto setup = load_setup(options, *data_folder, console);
  if (!setup) return failure(setup.error());
  const auto source = load_source(options, *data_folder, console);
  if (!source) return failure(source.error());
  if (source->human.map.partial) leave_out_missing(source->human, setup->tables, console);
  console.line("robot", setup->robot->name() + ", " +
                            count_text(static_cast<long>(setup->robot->joints().size()), "joint") +
                            ", limits " + setup->limits.name + ", mapping " + setup->tables.file);

  // from here on Ctrl-C stops between two frames and leaves nothing behind
  const InterruptGuard guard;
  auto sink =
      CsvSink::open(options.output, setup->robot, {csv_options(options), options.normalize_start});
  if (!sink) return failure(sink.error());
  const auto result = solve(*source, *setup, options, **sink, console);
  if (!result) return failure(result.error());
  const RobotClip& motion = result->clip;
  console.line("solved",
               count_text(motion.frame_count(), "frame") + " at " + to_text(motion.rate()) +
                   " fps, " +
                   number_text(static_cast<double>(result->steps) / motion.frame_count(), 2) +
                   " IK steps a frame");
  print_limits(motion, setup->limits, console);
  if (InterruptGuard::interrupted()) return interrupted_failure();
  if (auto written = (*sink)->finish(); !written) return written;
  console.line("wrote", (options.output == "-" ? "standard output" : options.output) + " in " +
                            number_text(seconds_since(start), 2) + " s");
  return {};
}

}  // namespace

ExitCode run(const RunOptions& options, Console& console) {
  const auto done = run_checked(options, console);
  return done ? kDone : console.fail(done.error());
}

}  // namespace retarget::cli
