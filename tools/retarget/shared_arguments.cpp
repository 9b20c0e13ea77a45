#include "shared_arguments.h"

#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "base/data_folder.h"
#include "base/try.h"
#include "plan/check_options.h"

namespace retarget::cli {

Result<std::string> data_folder_of(const CommonArguments& common) {
  const auto& chosen = common.data_dir;
  TRY_ASSIGN(const auto folder,
             find_data_folder(chosen.empty() ? std::nullopt : std::optional(chosen)));
  return folder.string();
}

Result<void> take_smpl_file(RunArguments& arguments) {
  if (arguments.smpl_file.empty()) return {};
  if (!arguments.run.motion.empty()) {
    return usage_failure("--bvh and --smpl both name a motion", "give one of them");
  }
  arguments.run.motion = arguments.smpl_file;
  arguments.run.options.source.smpl = true;
  return {};
}

Result<void> check_no_folder(const std::string& path) {
  std::error_code ignored;
  if (path.empty() || !std::filesystem::is_directory(path, ignored)) return {};
  return input_failure(path, "expected a motion file, found a directory",
                       "retarget batch " + path + " -o OUT --robot NAME takes a folder of clips");
}

Result<LoadedRobot> load_robot(const RobotChoice& choice, const CommonArguments& common,
                               Console& console, Soles soles) {
  TRY_ASSIGN(LoadedRobot robot,
             retarget::load_robot(choice, DataFolder{common.data_dir, {}}, soles));
  console.lines(robot.notes);
  console.warn(robot.warnings, robot.model);
  return robot;
}

Result<RobotSetup> set_up_robot(const Run& run, const CommonArguments& common, Console& console) {
  TRY_ASSIGN(LoadedRobot robot, load_robot(run.robot, common, console));
  return retarget::set_up_robot(std::move(robot), run.options);
}

}  // namespace retarget::cli
