// `retarget simulate`: replays a robot motion in a physics simulation.

#include <optional>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/motion_io.h"
#include "retarget/option_table.h"
#include "retarget/run.h"
#include "retarget/simulate.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

Result<void> check_usage(const SimulateArguments& arguments) {
  RETARGET_TRY(check_robot_choice(arguments.robot));
  std::vector<std::string> read = {arguments.input};
  Run run;
  run.robot = arguments.robot;
  const std::vector<std::string> of_robot = files_read(run, arguments.common);
  read.insert(read.end(), of_robot.begin(), of_robot.end());
  if (!arguments.output.empty()) {
    RETARGET_TRY(plan_outputs(arguments.output, arguments.save));
  }
  return check_written({arguments.output, arguments.report, arguments.json ? "-" : ""}, read);
}

}  // namespace

Result<ExitCode> simulate(const SimulateArguments& arguments, Console& console) {
  RETARGET_TRY(check_usage(arguments));
  RETARGET_TRY_ASSIGN(const LoadedRobot robot,
                      load_robot(arguments.robot, arguments.common, console));
  RETARGET_TRY_ASSIGN(const RobotMotion motion,
                      load_recorded_motion(arguments.input, robot.robot,
                                           read_motion_options(arguments.reading,
                                                               memory_share(arguments.memory_gb))));
  report_reading(arguments.input, motion, console);
  const InterruptGuard guard;
  SimulateOptions options;
  options.is_stopped = [&console] { return console.is_stopped(); };
  auto done = retarget::simulate(motion.clip, options);
  if (!done && done.error().location.file.empty()) done.error().location.file = arguments.input;
  RETARGET_TRY_ASSIGN(const Simulation simulation, std::move(done));
  if (!arguments.output.empty()) {
    RETARGET_TRY(
        write_motion(simulation.motion, std::nullopt, arguments.output, arguments.save, console));
  }
  const std::string json = simulation_json(simulation.report);
  if (!arguments.report.empty()) RETARGET_TRY(write_file(arguments.report, json));
  if (arguments.json) {
    RETARGET_TRY(write_file("-", printable_json(json)));
  } else if (arguments.output != "-" && arguments.report != "-") {
    RETARGET_TRY(write_file("-", simulation_text(simulation.report)));
  }
  // A fall is a result, not an error; the exit code reports it.
  return simulation.report.fell ? kRunFailed : kDone;
}

}  // namespace retarget::cli
