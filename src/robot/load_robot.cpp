#include "retarget/robot/load_robot.h"

#include <algorithm>
#include <system_error>

#include "retarget/base/suggest.h"
#include "robot/load_model.h"
#include "robot/load_profile.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

bool is_robot_folder(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "model.xml", ignored);
}

}  // namespace

Result<std::shared_ptr<const Robot>> load_robot(const std::string& model_path,
                                                const std::string& profile_path) {
  const auto model = load_model(model_path);
  if (!model) return failure(model.error());
  RobotProfile bare;
  bare.name = fs::path(model_path).stem().string();
  auto robot = std::make_shared<Robot>(*model, std::move(bare));
  if (profile_path.empty()) return robot;
  auto profile = load_profile(profile_path, *robot);
  if (!profile) return failure(profile.error());
  robot->set_profile(std::move(*profile));
  return robot;
}

Result<RobotFiles> find_robot(const std::string& name_or_folder, const fs::path& robots_folder) {
  for (const fs::path& folder : {robots_folder / name_or_folder, fs::path(name_or_folder)}) {
    if (is_robot_folder(folder)) return RobotFiles{folder / "model.xml", folder / "robot.json"};
  }
  const std::vector<std::string> known = list_robots(robots_folder);
  return config_failure(
      "", "no robot \"" + name_or_folder + "\"" + did_you_mean(name_or_folder, known),
      "known robots: " + list_names(known) + "; any other: --robot-xml FILE --ik-config FILE");
}

std::vector<std::string> list_robots(const fs::path& robots_folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(robots_folder, ignored)) {
    if (is_robot_folder(entry.path())) names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace retarget
