// `retarget convert`: robot motions from one format to another.

#include <cstddef>
#include <string>
#include <utility>

#include "arguments.h"
#include "base/number_text.h"
#include "base/try.h"
#include "commands.h"
#include "console.h"
#include "motion/resample.h"
#include "plan/check_options.h"
#include "plan/memory.h"
#include "read_motion.h"
#include "retarget/clip.h"
#include "retarget/load.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "robot/resample_robot.h"
#include "robot/variant.h"
#include "run/outputs.h"
#include "run/written_files.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

Result<void> check_usage(const ConvertArguments& arguments) {
  TRY(check_robot_choice(arguments.robot));
  Run run;
  run.motion = arguments.input;
  run.robot = arguments.robot;
  run.options.save = arguments.save;
  run.output = arguments.output;
  return check_outputs(run, false, files_read(run, arguments.common), {});
}

Result<RobotClip> at_rate(RobotClip clip, std::size_t file_bytes,
                          const ConvertArguments& arguments) {
  const TimeOptions& time = arguments.time;
  const FrameRate output = time.fps ? frame_rate_from_fps(*time.fps) : clip.rate();
  const MotionNeed need{resampled_frame_count(clip.frame_count(), clip.rate(), output), output,
                        file_bytes, arguments.input, false};
  TRY(check_need(need, arguments.memory_gb, arguments.save));
  if (!time.fps) return clip;
  auto resampled = resample_robot(clip, output, {time.interpolation, !time.no_antialias});
  if (!resampled) resampled.error().location.file = arguments.input;
  return resampled;
}

// the motion of the whole robot, or of the variant that is asked for
Result<RobotClip> load_motion(const ConvertArguments& arguments, Console& console) {
  // the file may have joints that the variant holds: it is read as of the whole robot
  RobotChoice whole = arguments.robot;
  whole.variant.clear();
  TRY_ASSIGN(const LoadedRobot robot,
             load_robot(whole, arguments.common, console, Soles::kAsTheyAre));
  TRY_ASSIGN(RobotMotion motion,
             load_robot_motion(arguments.input, robot.robot,
                               read_motion_options(arguments.reading, arguments.memory_gb)));
  print_motion(arguments.input, motion, console);
  const std::string& name = arguments.robot.variant;
  if (name.empty()) return at_rate(std::move(motion.clip), motion.bytes, arguments);
  TRY_ASSIGN(auto variant, robot_variant(robot.robot, name));
  if (const auto lost = lost_joints(motion.clip, *variant)) {
    console.warn({{0, 0, *lost}}, arguments.input);
  }
  return at_rate(with_robot(motion.clip, std::move(variant)), motion.bytes, arguments);
}

}  // namespace

Result<void> convert(const ConvertArguments& arguments, Console& console) {
  TRY(check_usage(arguments));
  TRY_ASSIGN(const RobotClip clip, load_motion(arguments, console));
  TRY_ASSIGN(const auto outputs, MotionOutputs::open(arguments.output, arguments.save,
                                                     clip.shared_robot(), clip.rate()));
  for (int frame = 0; frame < clip.frame_count(); ++frame) outputs->add(clip.qpos(frame));
  TRY_ASSIGN(const auto files, outputs->finish(clip));
  warn_of_losses(clip, files, console);
  console.line("wrote", outputs_text(files) + ": " + count_text(clip.frame_count(), "frame") +
                            " at " + to_text(clip.rate()) + " fps");
  return {};
}

}  // namespace retarget::cli
