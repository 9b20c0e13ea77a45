// `retarget convert`: robot motions from one format to another.

#include <optional>

#include "commands.h"
#include "format_losses.h"
#include "memory_need.h"
#include "outputs.h"
#include "retarget/motion_io.h"
#include "robot/resample_robot.h"
#include "robot/variant.h"
#include "robot_motion_options.h"
#include "run_setup.h"
#include "written_files.h"

namespace retarget::cli {
namespace {

Result<void> check_usage(const ConvertOptions& options) {
  if (auto robot = check_robot_choice(options.run); !robot) return robot;
  std::vector<std::string> inputs = files_of(options.run);
  inputs.push_back(options.input);
  return check_outputs(options.run, inputs, {});
}

Result<RobotClip> at_rate(RobotClip clip, std::size_t file_bytes, const ConvertOptions& options) {
  const auto rate = output_rate(options.run.fps);
  if (!rate) return failure(rate.error());
  const FrameRate output = rate->value_or(clip.rate());
  const MotionNeed need{resampled_frame_count(clip.frame_count(), clip.rate(), output), output,
                        file_bytes, options.input, false};
  if (auto fits = check_need(need, options.run); !fits) return failure(fits.error());
  if (!*rate) return clip;
  ResampleOptions resample_options;
  resample_options.interpolation =
      options.run.interpolation == "linear" ? Interpolation::kLinear : Interpolation::kCubic;
  resample_options.antialias = !options.run.no_antialias;
  auto resampled = resample_robot(clip, **rate, resample_options);
  if (!resampled) resampled.error().location.file = options.input;
  return resampled;
}

Result<void> convert_checked(const ConvertOptions& options, Console& console) {
  if (auto usage = check_usage(options); !usage) return usage;
  const auto data_folder = data_folder_of(options.run.common);
  if (!data_folder) return failure(data_folder.error());
  const auto read_options = read_motion_options(options.reading, options.run.source);
  if (!read_options) return failure(read_options.error());
  // the file may have joints that the variant holds: it is read as of the whole robot
  RunOptions whole = options.run;
  whole.dof.clear();
  const auto robot = load_chosen_robot(whole, *data_folder, console);
  if (!robot) return failure(robot.error());
  auto motion = read_motion(options.input, robot->robot, *read_options);
  if (!motion) return failure(motion.error());
  print_motion(options.input, *motion, console);
  RobotClip clip = std::move(motion->clip);
  if (!options.run.dof.empty()) {
    auto variant = robot_variant(robot->robot, options.run.dof);
    if (!variant) return failure(variant.error());
    if (const auto lost = lost_joints(clip, **variant)) {
      console.warn({{0, 0, *lost}}, options.input);
    }
    clip = with_robot(clip, std::move(*variant));
  }
  auto resampled = at_rate(std::move(clip), motion->bytes, options);
  if (!resampled) return failure(resampled.error());
  auto outputs = MotionOutputs::open(options.run, resampled->shared_robot(), resampled->rate());
  if (!outputs) return failure(outputs.error());
  for (int frame = 0; frame < resampled->frame_count(); ++frame) {
    (*outputs)->add(resampled->qpos(frame));
  }
  const auto files = (*outputs)->finish(*resampled);
  if (!files) return failure(files.error());
  warn_of_losses(options.run, *resampled, console);
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
