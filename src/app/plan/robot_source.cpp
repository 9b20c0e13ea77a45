#include "app/plan/robot_source.h"

#include <fmt/format.h>
#include <filesystem>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "human/skeleton/robot_human.h"
#include "retarget/check_options.h"
#include "retarget/motion_io.h"
#include "retarget/option_table.h"
#include "solve/targets/robot_as_human.h"

namespace retarget {

namespace fs = std::filesystem;

namespace {

Result<ResolvedConfig> config_of(const LoadedRobot& robot) {
  TRY_ASSIGN(const ConfigFiles files,
             find_configs({}, Method::kFit, fs::path(robot.model).parent_path(), robot.data_folder,
                          fs::path(robot.robot->name()).filename().string()));
  return load_config(files.of_lafan1, *robot.robot);
}

Result<Clip> clip_of(const RobotClip& motion, const SourceRobot& robot, const std::string& name) {
  TRY_ASSIGN(const RobotAsHuman as_human, RobotAsHuman::make(*robot.loaded.robot, robot.config));
  if (motion.shared_robot() == robot.loaded.robot) {
    return clip_of_robot_human(as_human.human_of(motion), name);
  }
  const RobotClip whole = with_robot(motion, robot.loaded.robot);
  return clip_of_robot_human(as_human.human_of(whole), name);
}

// Returns the name of the first option that differs from its default; empty if there is none.
template <typename Table, typename Value>
std::string given(Table table, const Value& value) {
  Value given = value, none;
  const auto names = changed_options(table(given), table(none));
  return names.empty() ? std::string() : names.front();
}

Failure not_of_robots(const std::string& option) {
  return usage_failure(marked_option(option) + " applies only to human motions, and " OPTION(
                                                   "from-robot") " declares a robot motion",
                       "omit one of them");
}

// A human's motion does not need a source robot.
Error about_source(Error error) {
  if (error.message.find(", a human motion") != std::string::npos) {
    error.hint = "omit " OPTION("from-robot");
  }
  return error;
}

}  // namespace

Result<void> check_robot_source(const SourceOptions& options) {
  if (options.from_robot.empty()) {
    const std::string name = given(
        [](MotionFileOptions& each) { return motion_file_table(each, true); }, options.robot_file);
    if (name.empty()) return {};
    return usage_failure(marked_option(name) + " applies only to robot motions",
                         "add " OPTION("from-robot") " NAME, or omit it");
  }
  if (options.smpl) return not_of_robots("smpl");
  if (!options.smpl_model.empty()) return not_of_robots("smpl-model");
  if (!options.joint_names.empty()) return not_of_robots("joint-names");
  if (!options.root.empty()) return not_of_robots("root");
  if (options.lenient) return not_of_robots("lenient");
  return {};
}

Result<void> check_human_of_robot(const HumanOptions& options) {
  // The axes of a robot's motion may differ from those of its model, so `up` is allowed.
  HumanOptions others = options;
  others.up.reset();
  const std::string name = given([](HumanOptions& each) { return human_table(each); }, others);
  if (!name.empty()) return not_of_robots(name);
  return {};
}

FitOptions fit_of_robot_motions(FitOptions fit) {
  TrackingWeights& weights = fit.weights;
  for (double* weight : {&weights.hips_rotation, &weights.torso_rotation, &weights.foot_rotation,
                         &weights.upper_arm_rotation, &weights.forearm_rotation,
                         &weights.hand_rotation, &weights.other_rotation}) {
    *weight *= 2.5;
  }
  // A robot's limbs can follow the twist of another robot's limbs.
  constexpr double kLegs = 20.0;  // Per radian, if the options have their defaults.
  const TrackingWeights usual;
  weights.thigh_rotation *= kLegs / usual.thigh_rotation;
  weights.thigh_twist = weights.thigh_rotation;
  weights.shank_rotation *= kLegs / usual.shank_rotation;
  weights.shank_twist = weights.shank_rotation;
  weights.straight_upper_arm_twist = 1.0;
  for (double* weight : {&fit.smoothness_leg, &fit.smoothness_arm, &fit.smoothness_wrist}) {
    *weight *= 1.5;
  }
  fit.smoothness_root_position *= 25.0 / 18.0;
  fit.limb_smoothing_time = 0.0;
  fit.smoothness_root_rotation *= 2.5;
  return fit;
}

Result<SourceRobot> load_source_robot(const std::string& name, const DataFolder& data_folder) {
  RobotChoice choice;
  choice.name = name;
  SourceRobot robot;
  auto loaded = load_robot(choice, data_folder);
  if (!loaded) {
    Error error = loaded.error();
    if (error.location.file.empty()) error.message += " (" OPTION("from-robot") ")";
    return failure(std::move(error));
  }
  robot.loaded = *std::move(loaded);
  TRY_ASSIGN(robot.config, config_of(robot.loaded));
  return robot;
}

Result<Clip> load_robot_clip(const std::string& file, const SourceOptions& options,
                             const DataFolder& data_folder) {
  TRY(check_robot_source(options));
  TRY_ASSIGN(const SourceRobot robot, load_source_robot(options.from_robot, data_folder));
  ReadMotionOptions read =
      read_motion_options(options.robot_file, options.source_fps, options.take);
  read.max_bytes = memory_share(options.memory_gb);
  auto motion = load_robot_motion(file, robot.loaded.robot, read);
  if (!motion) return failure(about_source(std::move(motion).error()));
  TRY_ASSIGN(Clip clip, clip_of(motion->clip, robot, file == "-" ? "standard input" : file));
  ClipOrigin origin = clip.origin();
  origin.bytes = motion->bytes;
  origin.choices = fmt::format(
      "{} of the robot {}{}", format_name(motion->format), robot.loaded.robot->name(),
      motion->rate_known ? "" : ", which states no rate: " OPTION("source-fps") " sets it");
  for (const std::string& warning : motion->warnings) origin.warnings.push_back({0, 0, warning});
  clip.set_origin(std::move(origin));
  return clip;
}

Result<Clip> clip_of_robot(const RobotClip& motion, const LoadedRobot& robot,
                           const std::string& name) {
  TRY_ASSIGN(ResolvedConfig config, config_of(robot));
  return clip_of(motion, {robot, std::move(config)}, name);
}

}  // namespace retarget
