// The files of robots by name: for lists, descriptions and checks.

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/options.h"
#include "retarget/rig.h"
#include "retarget/robots.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Adds the configurations next to the model and in the data folder.
RobotSources with_configs(const fs::path& model, const fs::path& profile,
                          const std::string& data_folder) {
  const fs::path named = model.parent_path();
  const fs::path folder = named.empty() ? fs::path(".") : named;
  const auto found =
      find_configs({}, Method::kGmr, folder, data_folder, fs::absolute(folder).filename().string());
  const ConfigFiles configs = found.value_or(ConfigFiles{});
  return {{}, model.string(), profile.string(), configs.of_lafan1, configs.of_others};
}

}  // namespace

Result<RobotSources> find_robot_sources(const std::string& name_or_folder,
                                        const std::string& data_folder) {
  RETARGET_TRY_ASSIGN(const auto files, find_robot(name_or_folder, robot_folders(data_folder)));
  return with_configs(files.model, files.profile, data_folder);
}

RobotSources sources_of_model(const fs::path& model, const std::string& data_folder) {
  const fs::path profile = model.parent_path() / "robot.json";
  return with_configs(model, is_file(profile) ? profile : fs::path(), data_folder);
}

Result<std::vector<RobotSources>> list_robot_sources(const std::string& data_folder) {
  const RobotFolders folders = robot_folders(data_folder);
  const std::vector<std::string> installed = list_robots(folders);
  std::vector<RobotSources> robots;
  for (const std::string& name : installed) {
    RETARGET_TRY_ASSIGN(auto robot, find_robot_sources(name, data_folder));
    robot.name = name;
    robots.push_back(std::move(robot));
  }
  RETARGET_TRY_ASSIGN(const auto known, known_robots(folders));
  for (const KnownRobot& robot : known) {
    if (std::ranges::find(installed, robot.name) != installed.end()) continue;
    RobotSources left_out;
    left_out.name = robot.name;
    left_out.description = robot.description;
    left_out.licence = robot.licence;
    left_out.licence_stated = robot.in_packages;
    robots.push_back(std::move(left_out));
  }
  std::ranges::sort(robots, {}, &RobotSources::name);
  return robots;
}

}  // namespace retarget
