#include "shared_arguments.h"

#include <filesystem>
#include <optional>
#include <utility>

#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget::cli {

Result<std::string> data_folder_of(const CommonArguments& common) {
  return find_data_folder(DataFolder{common.data_dir});
}

Result<void> take_smpl_file(RunArguments& arguments) {
  if (arguments.smpl_file.empty()) return {};
  if (!arguments.run.motion.empty()) {
    return usage_failure("--bvh and --smpl both name a motion", "give only one of them");
  }
  // A second call changes nothing.
  arguments.run.motion = std::exchange(arguments.smpl_file, {});
  arguments.run.options.source.smpl = true;
  return {};
}

std::vector<std::string> files_read(const Run& run, const CommonArguments& common) {
  return files_of(run, data_folder_of(common).value_or(std::string()));
}

Result<std::optional<double>> rate_of(const std::string& fps) {
  auto rate = rate_from_text(fps);
  if (!rate) return usage_failure("--fps: " + rate.error().message);
  return rate;
}

Result<LoadedRobot> load_robot(const RobotChoice& choice, const CommonArguments& common,
                               Console& console, Soles soles) {
  return retarget::load_robot(choice, DataFolder{common.data_dir}, console, soles);
}

Result<RobotSetup> set_up_robot(const Run& run, const CommonArguments& common, Console& console) {
  RETARGET_TRY_ASSIGN(LoadedRobot robot, load_robot(run.robot, common, console));
  return retarget::set_up_robot(std::move(robot), run.options);
}

bool is_glb_name(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string()) == ".glb";
}

}  // namespace retarget::cli
