// `retarget convert`: robot motions from one format to another.

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include "base/located.h"
#include "base/number_text.h"
#include "base/try.h"
#include "commands.h"
#include "human_glb.h"

#include "arguments.h"
#include "console.h"
#include "motion/resample.h"
#include "options/run_tables.h"
#include "plan/check_options.h"
#include "plan/memory.h"
#include "plan/output_files.h"
#include "read_motion.h"
#include "retarget/clip.h"
#include "retarget/load.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "robot/resample_robot.h"
#include "robot/variant.h"
#include "run/outputs.h"
#include "run/recorded_motion.h"
#include "run/written_files.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

// a motion of a human: of no robot, and to a file that shows it
bool is_of_human(const ConvertArguments& arguments) {
  ConvertArguments copy = arguments;
  // options of robots and their files
  OptionTable rows = reading_table(copy.reading);
  append(rows, robot_table(copy.robot));
  ConvertArguments without_options;
  OptionTable defaults = reading_table(without_options.reading);
  append(defaults, robot_table(without_options.robot));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (to_text(rows[i].get()) != to_text(defaults[i].get())) return false;
  }
  const auto items = plan_outputs(arguments.output, arguments.save);
  return items && items->size() == 1 && items->front().format == MotionFormat::kGlb;
}

Result<void> check_usage(const ConvertArguments& arguments) {
  if (!is_of_human(arguments)) TRY(check_robot_choice(arguments.robot));
  Run run;
  run.motion = arguments.input;
  run.robot = arguments.robot;
  run.options.save = arguments.save;
  run.output = arguments.output;
  return check_outputs(run, false, files_read(run, arguments.common), {});
}

// a motion to be written, with what its file tells of contacts
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
  TRY(check_need(need, arguments.memory_gb, arguments.save));
  if (!time.fps) return clip;
  auto resampled = resample_robot(clip, output, {time.interpolation, !time.no_antialias});
  if (!resampled) resampled.error().location.file = arguments.input;
  return resampled;
}

// the motion of the whole robot, or of the variant that is asked for
Result<ReadMotion> load_motion(const ConvertArguments& arguments, Console& console) {
  // the file may have joints that the variant holds: it is read as of the whole robot
  RobotChoice whole = arguments.robot;
  whole.variant.clear();
  TRY_ASSIGN(const LoadedRobot robot,
             load_robot(whole, arguments.common, console, Soles::kAsTheyAre));
  TRY_ASSIGN(RobotMotion motion,
             load_recorded_motion(arguments.input, robot.robot,
                                  read_motion_options(arguments.reading, arguments.memory_gb)));
  print_motion(arguments.input, motion, console);
  const std::string& name = arguments.robot.variant;
  const FrameRate file_rate = motion.clip.rate();
  RobotClip read = std::move(motion.clip);
  if (!name.empty()) {
    TRY_ASSIGN(auto variant, robot_variant(robot.robot, name));
    if (const auto lost = lost_joints(read, *variant)) {
      console.warn({{0, 0, *lost}}, arguments.input);
    }
    read = with_robot(read, std::move(variant));
  }
  TRY_ASSIGN(RobotClip clip, at_rate(std::move(read), motion.bytes, arguments));
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
    hint += (hint.empty() ? "" : "; ") + std::string("a robot's motion needs --robot NAME");
    return failure(std::move(read).error());
  }
  Clip clip = *std::move(read);
  console.warn(clip.origin().warnings, clip.name());
  const TimeOptions& time = arguments.time;
  if (time.fps) {
    TRY_ASSIGN(clip, located(resample(std::move(clip), frame_rate_from_fps(*time.fps),
                                      {time.interpolation, !time.no_antialias}),
                             arguments.input));
  }
  const std::string summary =
      count_text(clip.frame_count(), "frame") + " at " + to_text(clip.rate()) + " fps";
  TRY(save_human_glb(arguments.output, std::move(clip), {}, arguments.common, console));
  console.line("wrote",
               (arguments.output == "-" ? "standard output" : arguments.output) + ": " + summary);
  return {};
}

}  // namespace

Result<void> convert(const ConvertArguments& arguments, Console& console) {
  TRY(check_usage(arguments));
  if (is_of_human(arguments)) return convert_human(arguments, console);
  TRY_ASSIGN(const ReadMotion motion, load_motion(arguments, console));
  const RobotClip& clip = motion.clip;
  TRY_ASSIGN(const auto outputs, MotionOutputs::open(arguments.output, arguments.save,
                                                     clip.shared_robot(), clip.rate()));
  for (int frame = 0; frame < clip.frame_count(); ++frame) outputs->add(clip.qpos(frame));
  const OutputMotion written{&clip, std::nullopt, motion.contacts};
  TRY_ASSIGN(const auto files, outputs->finish({&written, 1}));
  warn_of_losses(clip, files, console);
  console.line("wrote", outputs_text(files) + ": " + count_text(clip.frame_count(), "frame") +
                            " at " + to_text(clip.rate()) + " fps");
  return {};
}

}  // namespace retarget::cli
