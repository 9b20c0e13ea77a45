// `retarget convert`: converts robot motions between formats.

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/check_options.h"
#include "retarget/clip.h"
#include "retarget/load.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/resample.h"
#include "retarget/robot.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

// Returns true for a human motion: no robot options are given, and the only output is a GLB.
bool is_of_human(const ConvertArguments& arguments) {
  ConvertArguments copy = arguments;
  // Options for robots and their files.
  OptionTable rows = reading_table(copy.reading);
  append(rows, robot_table(copy.robot));
  ConvertArguments without_options;
  OptionTable defaults = reading_table(without_options.reading);
  append(defaults, robot_table(without_options.robot));
  if (!changed_options(rows, defaults).empty()) return false;
  // Only robots have references.
  if (arguments.save.reference_rate > 0.0 || !arguments.save.reference.empty()) return false;
  const auto items = plan_outputs(arguments.output, arguments.save);
  return items && items->size() == 1 && items->front().format == MotionFormat::kGlb;
}

Result<void> check_usage(const ConvertArguments& arguments) {
  if (!is_of_human(arguments)) RETARGET_TRY(check_robot_choice(arguments.robot));
  Run run;
  run.motion = arguments.input;
  run.robot = arguments.robot;
  run.options.save = arguments.save;
  run.output = arguments.output;
  return check_outputs(run, false, files_read(run, arguments.common), {});
}

// A motion to write, with the contacts stored in its file.
struct ReadMotion {
  RobotClip clip;
  std::optional<FootContacts> contacts;
};

Result<RobotClip> at_rate(RobotClip clip, std::size_t file_bytes,
                          const ConvertArguments& arguments) {
  const TimeOptions& time = arguments.time;
  const FrameRate output = time.fps ? frame_rate_from_fps(*time.fps) : clip.rate();
  const MotionNeed need{resampled_frame_count(clip.frame_count(), clip.rate(), output), output,
                        file_bytes, arguments.input, false};
  RETARGET_TRY(check_need(need, arguments.memory_gb, arguments.save));
  if (!time.fps) return clip;
  auto resampled = resample_robot(clip, output, {time.interpolation, !time.no_antialias});
  if (!resampled) resampled.error().location.file = arguments.input;
  return resampled;
}

// Loads the motion of the whole robot, or of the requested variant.
Result<ReadMotion> load_motion(const ConvertArguments& arguments, Console& console) {
  // The file may contain joints that the variant locks, so read it as a motion of the whole robot.
  RobotChoice whole = arguments.robot;
  whole.variant.clear();
  RETARGET_TRY_ASSIGN(const LoadedRobot robot,
                      load_robot(whole, arguments.common, console, Soles::kAsTheyAre));
  RETARGET_TRY_ASSIGN(RobotMotion motion,
                      load_recorded_motion(arguments.input, robot.robot,
                                           read_motion_options(arguments.reading,
                                                               memory_share(arguments.memory_gb))));
  report_reading(arguments.input, motion, console);
  const std::string& name = arguments.robot.variant;
  const FrameRate file_rate = motion.clip.rate();
  RobotClip read = std::move(motion.clip);
  if (!name.empty()) {
    RETARGET_TRY_ASSIGN(auto variant, robot_variant(robot.robot, name));
    if (const auto lost = lost_joints(read, *variant)) {
      console.warn({{0, 0, *lost}}, arguments.input);
    }
    read = with_robot(read, std::move(variant));
  }
  RETARGET_TRY_ASSIGN(RobotClip clip, at_rate(std::move(read), motion.bytes, arguments));
  if (motion.contacts) {
    motion.contacts =
        resample_contacts(*motion.contacts, file_rate, clip.rate(), clip.frame_count());
  }
  return ReadMotion{std::move(clip), std::move(motion.contacts)};
}

Result<void> convert_human(const ConvertArguments& arguments, Console& console) {
  SourceOptions source;
  source.memory_gb = arguments.memory_gb;
  auto read = load_clip(arguments.input, source);
  if (!read) {
    std::string& hint = read.error().hint;
    hint += (hint.empty() ? "" : "; ") + std::string("a robot motion needs --robot NAME");
    return failure(std::move(read).error());
  }
  Clip clip = *std::move(read);
  console.warn(clip.origin().warnings, clip.name());
  const TimeOptions& time = arguments.time;
  if (time.fps) {
    auto resampled = resample(std::move(clip), frame_rate_from_fps(*time.fps),
                              {time.interpolation, !time.no_antialias});
    if (!resampled) resampled.error().location.file = arguments.input;
    RETARGET_TRY_ASSIGN(clip, std::move(resampled));
  }
  const std::string summary =
      count_text(clip.frame_count(), "frame") + " at " + to_text(clip.rate()) + " fps";
  RETARGET_TRY(save_human_glb(arguments.output, std::move(clip), {}, arguments.common, console));
  console.line("wrote",
               (arguments.output == "-" ? "standard output" : arguments.output) + ": " + summary);
  return {};
}

}  // namespace

Result<void> convert(const ConvertArguments& arguments, Console& console) {
  RETARGET_TRY(check_usage(arguments));
  if (is_of_human(arguments)) return convert_human(arguments, console);
  RETARGET_TRY_ASSIGN(const ReadMotion motion, load_motion(arguments, console));
  RETARGET_TRY(
      write_motion(motion.clip, motion.contacts, arguments.output, arguments.save, console));
  return {};
}

}  // namespace retarget::cli
