// `retarget view`: a picture of a robot's motion.

#include <algorithm>
#include <filesystem>
#include <optional>

#include "base/file.h"
#include "commands.h"
#include "robot_motion_options.h"
#include "run_setup.h"
#include "view/strip.h"
#include "written_files.h"

namespace retarget::cli {
namespace {

Result<void> check_usage(const ViewOptions& options) {
  const RunOptions& run = options.run;
  if (auto robot = check_robot_choice(run); !robot) return robot;
  if (run.source.file.empty() && run.start_s >= 0.0) {
    return usage_failure("--start needs the source", "add --bvh FILE");
  }
  if (options.motion == "-" && run.source.file == "-") {
    return usage_failure("standard input can be read once only");
  }
  std::vector<std::string> inputs = files_of(run);
  inputs.push_back(options.motion);
  return check_written({run.output, run.human.write_map}, inputs);
}

// the human that the motion came from, frame by frame beside it
Result<std::optional<HumanClip>> source_human(RunOptions run, const FrameRate& rate,
                                              const std::filesystem::path& data_folder,
                                              Console& console) {
  std::optional<HumanClip> human;
  if (run.source.file.empty()) return human;
  run.fps = to_text(rate);
  const auto source = load_source(run, data_folder, console);
  if (!source) return failure(source.error());
  return to_human(source->clip, source->human.calibration.mapping);
}

Result<void> view_checked(const ViewOptions& options, Console& console) {
  RunOptions run = options.run;
  if (auto chosen = choose_motion_file(run); !chosen) return chosen;
  if (auto usage = check_usage(options); !usage) return usage;
  const auto data_folder = data_folder_of(run.common);
  if (!data_folder) return failure(data_folder.error());
  const auto read_options = read_motion_options(options.reading, run.source);
  if (!read_options) return failure(read_options.error());
  const auto robot = load_chosen_robot(run, *data_folder, console);
  if (!robot) return failure(robot.error());
  const auto motion = read_motion(options.motion, robot->robot, *read_options);
  if (!motion) return failure(motion.error());
  print_motion(options.motion, *motion, console);
  const auto human = source_human(run, motion->clip.rate(), *data_folder, console);
  if (!human) return failure(human.error());
  const std::string svg =
      draw_strip(motion->clip, *human ? &**human : nullptr,
                 {options.strip, std::filesystem::path(options.motion).filename().string() + ", " +
                                     robot->robot->name()});
  if (auto written = write_file(run.output, svg); !written) return written;
  console.line(
      "wrote",
      run.output + ": " + count_text(std::min(options.strip, motion->clip.frame_count()), "pose"));
  return {};
}

}  // namespace

ExitCode view(const ViewOptions& options, Console& console) {
  const auto done = view_checked(options, console);
  return done ? kDone : console.fail(done.error());
}

}  // namespace retarget::cli
