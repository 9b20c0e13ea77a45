// `retarget convert`: robot motions from one format to another.

#include "base/try.h"
#include "commands.h"
#include "memory_need.h"
#include "outputs.h"
#include "robot/resample_robot.h"
#include "robot/variant.h"
#include "robot_motion_options.h"
#include "run_setup.h"
#include "written_files.h"

namespace retarget::cli {
namespace {

Result<void> check_usage(const ConvertOptions& options) {
  TRY(check_robot_choice(options.run));
  std::vector<std::string> inputs = files_of(options.run);
  inputs.push_back(options.input);
  return check_outputs(options.run, inputs, {});
}

Result<RobotClip> at_rate(RobotClip clip, std::size_t file_bytes, const ConvertOptions& options) {
  TRY_ASSIGN(const auto rate, output_rate(options.run.fps));
  const FrameRate output = rate.value_or(clip.rate());
  const MotionNeed need{resampled_frame_count(clip.frame_count(), clip.rate(), output), output,
                        file_bytes, options.input, false};
  TRY(check_need(need, options.run));
  if (!rate) return clip;
  ResampleOptions resample_options;
  resample_options.interpolation =
      options.run.interpolation == "linear" ? Interpolation::kLinear : Interpolation::kCubic;
  resample_options.antialias = !options.run.no_antialias;
  auto resampled = resample_robot(clip, *rate, resample_options);
  if (!resampled) resampled.error().location.file = options.input;
  return resampled;
}

// the motion of the whole robot, or of the variant that is asked for
Result<RobotClip> load_clip(const ConvertOptions& options, Console& console) {
  TRY_ASSIGN(const auto data_folder, data_folder_of(options.run.common));
  TRY_ASSIGN(const auto read_options, read_motion_options(options.reading, options.run.source));
  // the file may have joints that the variant holds: it is read as of the whole robot
  RunOptions whole = options.run;
  whole.dof.clear();
  TRY_ASSIGN(const auto robot, load_chosen_robot(whole, data_folder, console));
  TRY_ASSIGN(auto motion, load_robot_motion(options.input, robot.robot, read_options));
  print_motion(options.input, motion, console);
  if (options.run.dof.empty()) return at_rate(std::move(motion.clip), motion.bytes, options);
  TRY_ASSIGN(auto variant, robot_variant(robot.robot, options.run.dof));
  if (const auto lost = lost_joints(motion.clip, *variant)) {
    console.warn({{0, 0, *lost}}, options.input);
  }
  return at_rate(with_robot(motion.clip, std::move(variant)), motion.bytes, options);
}

Result<void> convert_checked(const ConvertOptions& options, Console& console) {
  TRY(check_usage(options));
  TRY_ASSIGN(const auto clip, load_clip(options, console));
  TRY_ASSIGN(const auto outputs,
             MotionOutputs::open(options.run, clip.shared_robot(), clip.rate()));
  for (int frame = 0; frame < clip.frame_count(); ++frame) outputs->add(clip.qpos(frame));
  TRY_ASSIGN(const auto files, outputs->finish(clip));
  warn_of_losses(options.run, clip, console);
  console.line("wrote", outputs_text(files) + ": " + count_text(clip.frame_count(), "frame") +
                            " at " + to_text(clip.rate()) + " fps");
  return {};
}

}  // namespace

ExitCode convert(const ConvertOptions& options, Console& console) {
  const auto done = convert_checked(options, console);
  return done ? kDone : console.fail(done.error());
}

}  // namespace retarget::cli
