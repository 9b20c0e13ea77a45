// `retarget view`: a picture of a robot's motion.

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>

#include "arguments.h"
#include "base/file.h"
#include "base/number_text.h"
#include "base/try.h"
#include "commands.h"
#include "console.h"
#include "human/human_clip.h"
#include "plan/check_options.h"
#include "read_motion.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/load.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/solve.h"
#include "run/run_to_files.h"
#include "run/written_files.h"
#include "shared_arguments.h"
#include "view/strip.h"

namespace retarget::cli {
namespace {

Result<void> check_usage(const ViewArguments& arguments) {
  const Run& run = arguments.run.run;
  TRY(check_robot_choice(run.robot));
  if (run.motion.empty() && run.options.part.start_s >= 0.0) {
    return usage_failure("--start needs the source", "add --bvh FILE");
  }
  if (arguments.motion == "-" && run.motion == "-") {
    return usage_failure("standard input can be read only once");
  }
  auto inputs = files_read(run, arguments.run.common);
  inputs.push_back(arguments.motion);
  return check_written({run.output, arguments.run.request.write_map}, inputs);
}

// the human that the motion came from, frame by frame beside it
Result<std::optional<HumanClip>> source_human(RunArguments arguments, const LoadedRobot& robot,
                                              const FrameRate& rate, Console& console) {
  Run& run = arguments.run;
  if (run.motion.empty()) return std::optional<HumanClip>();
  run.options.time.fps = rate.fps();
  TRY_ASSIGN(const RobotSetup setup, retarget::set_up_robot(robot, run.options));
  TRY_ASSIGN(const Plan plan, read_and_plan(run, arguments.request, setup, console));
  TRY_ASSIGN(const auto clip, prepare_clip(plan));
  return std::optional(to_human(*clip, plan.human.calibration));
}

}  // namespace

Result<void> view(const ViewArguments& given, Console& console) {
  ViewArguments arguments = given;
  TRY(take_smpl_file(arguments.run));
  TRY(check_usage(arguments));
  const Run& run = arguments.run.run;
  TRY_ASSIGN(const LoadedRobot robot,
             load_robot(run.robot, arguments.run.common, console, Soles::kAsTheyAre));
  TRY_ASSIGN(
      const RobotMotion motion,
      load_robot_motion(arguments.motion, robot.robot,
                        read_motion_options(arguments.reading, run.options.source.memory_gb)));
  print_motion(arguments.motion, motion, console);
  TRY_ASSIGN(const auto human, source_human(arguments.run, robot, motion.clip.rate(), console));
  const std::string name = std::filesystem::path(arguments.motion).filename().string();
  TRY(write_file(run.output, draw_strip(motion.clip, human ? &*human : nullptr,
                                        {arguments.strip, name + ", " + robot.robot->name()})));
  console.line(
      "wrote",
      run.output + ": " + count_text(std::min(arguments.strip, motion.clip.frame_count()), "pose"));
  return {};
}

}  // namespace retarget::cli
