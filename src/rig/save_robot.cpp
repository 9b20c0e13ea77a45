#include <filesystem>
#include <string>
#include <system_error>

#include "retarget/file.h"
#include "retarget/json.h"
#include "retarget/option_name.h"
#include "retarget/rig.h"
#include "retarget/try.h"
#include "rig/robot_folder.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Returns true if robot.json indicates that make_robot created the folder.
bool is_made_robot(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  // Replacing would affect the link, not its target.
  if (!fs::is_directory(fs::symlink_status(folder, ignored))) return false;
  const fs::path profile = folder / "robot.json";
  if (!fs::is_regular_file(profile, ignored)) return false;
  const auto json = load_json(profile.string());
  if (!json || !json->is_object()) return false;
  const auto found = json->find("name");
  if (found == json->end() || !found->is_string() || found->get<std::string>() != name) {
    return false;
  }
  // Keys that make_robot always writes.
  for (const char* key : {"source", "joint_order", "speed_limits_source", "t_pose", "soles",
                          "allowed_self_contact"}) {
    if (!json->contains(key)) return false;
  }
  return true;
}

}  // namespace

Result<void> check_new_robot(const std::string& model_path, const std::string& name,
                             const fs::path& into) {
  RETARGET_TRY(check_robot_name(name));
  if (!is_below(model_path, into / name)) return {};
  return usage_failure("\"" + model_path + "\" is in the folder to be replaced, \"" + name + "\"",
                       "move the model out of it first");
}

Result<fs::path> save_robot(const MadeRobot& robot, const fs::path& into, bool force) {
  RETARGET_TRY(check_robot_name(robot.name));
  const fs::path folder = into / robot.name;
  const FileTexts files = {{"model.xml", robot.model},
                           {"robot.json", robot.profile},
                           {"ik.json", robot.config},
                           {"decisions.md", robot.decisions}};
  PutOptions options;
  options.replace = force;
  options.may_replace = [&](const fs::path& there) { return is_made_robot(there, robot.name); };
  options.otherwise = "robots add did not create it for a robot of this name";
  RETARGET_TRY(put_robot_folder(folder, files, options));
  return folder;
}

}  // namespace retarget
