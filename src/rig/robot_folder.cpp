#include "rig/robot_folder.h"

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

#include "retarget/file.h"
#include "retarget/json.h"
#include "retarget/option_name.h"
#include "retarget/os.h"
#include "retarget/rig.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

std::string system_message(int error_number) {
  return std::generic_category().message(error_number);
}

// Creates an empty folder with an unused name; returns errno on failure, 0 on success.
int make_new_folder(const fs::path& beside, fs::path& made) {
  constexpr int kMaxNames = 1000;
  for (int number = 0; number < kMaxNames; ++number) {
    made = beside.parent_path() / ("." + beside.filename().string() + ".new-" +
                                   std::to_string(os::process_id()) + "-" + std::to_string(number));
    if (os::make_folder(made.string()) == 0) return 0;
    if (errno != EEXIST) break;
  }
  return errno;
}

// Renames without replacing an existing file; returns errno or 0.
int rename_to_new(const fs::path& from, const fs::path& to) {
  return os::move_to_new(from.string(), to.string()) == 0 ? 0 : errno;
}

// Exchanges two folders, atomically if the file system supports it; returns errno or 0.
int exchange_folders(const fs::path& made, const fs::path& there) {
  if (os::exchange(made.string(), there.string()) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  // Rename over an empty folder, which rename permits.
  fs::path aside;
  if (const int error = make_new_folder(there, aside); error != 0) return error;
  if (os::move_over(there.string(), aside.string()) != 0) {
    const int error = errno;
    os::remove_folder(aside.string());
    return error;
  }
  if (os::move_over(made.string(), there.string()) != 0) {
    const int error = errno;
    // Restore the original folder.
    return os::move_over(aside.string(), there.string()) == 0 ? error : errno;
  }
  return os::move_over(aside.string(), made.string()) == 0 ? 0 : errno;
}

Result<void> fill(const fs::path& folder, const FileTexts& files,
                  const std::function<Result<void>(const fs::path&)>& check) {
  for (const auto& [file, text] : files) {
    RETARGET_TRY(write_file((folder / file).string(), text));
  }
  return check ? check(folder) : Result<void>();
}

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

Result<void> check_robot_name(const std::string& name) {
  const bool valid = is_plain_name(name) && !name.starts_with('.') && valid_utf8(name) == name &&
                     name.find_first_of("/\\") == std::string::npos;
  if (valid) return {};
  return usage_failure("\"" + name +
                       "\" is not a valid robot name: it must be a valid folder name");
}

namespace {

Result<void> check_place(const fs::path& folder, const PutOptions& options) {
  const fs::path into = folder.parent_path();
  std::error_code error;
  if (!fs::is_directory(into.empty() ? fs::path(".") : into, error)) {
    return usage_failure("the folder \"" + into.string() + "\" does not exist");
  }
  if (!fs::exists(fs::symlink_status(folder, error))) return {};
  if (!options.replace) {
    return usage_failure("\"" + folder.string() + "\" already exists",
                         RETARGET_OPTION("force") " replaces it");
  }
  if (!options.may_replace(folder)) {
    return usage_failure("\"" + folder.string() + "\" is not replaced: " + options.otherwise,
                         "give another name, or remove it yourself");
  }
  return {};
}

PutOptions options_for_made_robot(const std::string& name, bool force) {
  PutOptions options;
  options.replace = force;
  options.may_replace = [name](const fs::path& there) { return is_made_robot(there, name); };
  options.otherwise = "robots add did not create it for a robot of this name";
  return options;
}

}  // namespace

Result<void> put_robot_folder(const fs::path& folder, const FileTexts& files,
                              const PutOptions& options) {
  RETARGET_TRY(check_place(folder, options));
  std::error_code error;
  const bool is_there = fs::exists(fs::symlink_status(folder, error));
  // Write next to the destination, then move the folder into place in one step.
  fs::path staging;
  const int made = make_new_folder(folder, staging);
  const auto give_up = [&](const std::string& what) {
    std::error_code ignored;
    fs::remove_all(staging, ignored);
    return run_failure(folder.string(), "cannot write the robot folder: " + what);
  };
  if (made != 0) {
    staging.clear();
    return give_up(system_message(made));
  }
  if (auto filled = fill(staging, files, options.check); !filled) {
    if (filled.error().kind != ErrorKind::kConfig) return give_up(filled.error().message);
    fs::remove_all(staging, error);
    return failure(filled.error());
  }
  const int placed = is_there ? exchange_folders(staging, folder) : rename_to_new(staging, folder);
  if (placed != 0) return give_up(system_message(placed));
  // After the exchange, the staging folder holds the old content.
  if (is_there) fs::remove_all(staging, error);
  return {};
}

Result<void> check_new_robot(const std::string& model_path, const std::string& name,
                             const fs::path& into, bool force) {
  RETARGET_TRY(check_robot_name(name));
  if (is_below(model_path, into / name)) {
    return usage_failure("\"" + model_path + "\" is in the folder to be replaced, \"" + name + "\"",
                         "move the model out of it first");
  }
  return check_place(into / name, options_for_made_robot(name, force));
}

Result<fs::path> save_robot(const MadeRobot& robot, const fs::path& into, bool force) {
  RETARGET_TRY(check_robot_name(robot.name));
  const fs::path folder = into / robot.name;
  const FileTexts files = {{"model.xml", robot.model},
                           {"robot.json", robot.profile},
                           {"ik.json", robot.config},
                           {"decisions.md", robot.decisions}};
  RETARGET_TRY(put_robot_folder(folder, files, options_for_made_robot(robot.name, force)));
  return folder;
}

}  // namespace retarget
