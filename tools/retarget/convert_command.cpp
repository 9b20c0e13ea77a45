// `retarget convert`: robot motions from one format to another.

#include <algorithm>
#include <cmath>
#include <optional>

#include "commands.h"
#include "outputs.h"
#include "retarget/base/suggest.h"
#include "retarget/io/robot_motion.h"
#include "retarget/robot/resample_robot.h"
#include "retarget/robot/variant.h"
#include "robot_motion_options.h"
#include "run_setup.h"

namespace retarget::cli {
namespace {

Result<void> check_usage(const ConvertOptions& options) {
  if (auto robot = check_robot_choice(options.run); !robot) return robot;
  return check_outputs(options.run,
                       {options.input, options.run.robot_xml, options.run.robot_profile}, {});
}

// what the variant holds and the motion moves
void warn_of_held(const RobotClip& clip, const Robot& variant, const std::string& file,
                  Console& console) {
  std::vector<std::string> lost;
  double largest = 0.0;
  for (const auto& [name, held] : variant.variant().locked) {
    const auto joint = variant.find_joint(name);
    if (!joint) continue;
    double away = 0.0;
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      away =
          std::max(away, std::abs(clip.qpos(frame)[variant.joints()[*joint].qpos_address] - held));
    }
    constexpr double kNothing = 1e-6;
    if (away > kNothing) lost.push_back(name);
    largest = std::max(largest, away);
  }
  if (lost.empty()) return;
  console.warn({{0, 0,
                 count_text(static_cast<long>(lost.size()), "joint") +
                     " that move are held and lost, by up to " + number_text(largest, 3) + ": " +
                     list_names(lost, 6)}},
               file);
}

Result<RobotClip> at_rate(RobotClip clip, const ConvertOptions& options) {
  const auto rate = output_rate(options.run.fps);
  if (!rate) return failure(rate.error());
  if (!*rate) return clip;
  ResampleOptions resample_options;
  resample_options.interpolation =
      options.run.interpolation == "linear" ? Interpolation::kLinear : Interpolation::kCubic;
  resample_options.antialias = !options.run.no_antialias;
  auto resampled = resample_robot(clip, **rate, resample_options);
  if (!resampled) resampled.error().file = options.input;
  return resampled;
}

Result<void> convert_checked(const ConvertOptions& options, Console& console) {
  if (auto usage = check_usage(options); !usage) return usage;
  const auto data_folder = data_folder_of(options.run.common);
  if (!data_folder) return failure(data_folder.error());
  const auto read_options = read_motion_options(options.reading);
  if (!read_options) return failure(read_options.error());
  // the file may have joints that the variant holds: it is read as of the whole robot
  RunOptions whole = options.run;
  whole.dof.clear();
  const auto robot = load_chosen_robot(whole, *data_folder, console);
  if (!robot) return failure(robot.error());
  auto motion = load_robot_motion(options.input, robot->robot, *read_options);
  if (!motion) return failure(motion.error());
  print_motion(options.input, *motion, console);
  RobotClip clip = std::move(motion->clip);
  if (!options.run.dof.empty()) {
    auto variant = robot_variant(robot->robot, options.run.dof);
    if (!variant) return failure(variant.error());
    warn_of_held(clip, **variant, options.input, console);
    clip = with_robot(clip, std::move(*variant));
  }
  auto resampled = at_rate(std::move(clip), options);
  if (!resampled) return failure(resampled.error());
  auto outputs = MotionOutputs::open(options.run, resampled->shared_robot());
  if (!outputs) return failure(outputs.error());
  for (int frame = 0; frame < resampled->frame_count(); ++frame) {
    (*outputs)->add(resampled->qpos(frame));
  }
  const auto files = (*outputs)->finish(*resampled);
  if (!files) return failure(files.error());
  console.line("wrote", outputs_text(*files) + ": " +
                            count_text(resampled->frame_count(), "frame") + " at " +
                            to_text(resampled->rate()) + " fps");
  return {};
}

}  // namespace

ExitCode convert(const ConvertOptions& options, Console& console) {
  const auto done = convert_checked(options, console);
  return done ? kDone : console.fail(done.error());
}

}  // namespace retarget::cli
