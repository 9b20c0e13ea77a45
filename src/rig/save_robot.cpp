#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>

#include "base/file.h"
#include "base/json.h"
#include "base/option_name.h"
#include "base/plain_name.h"
#include "base/try.h"
#include "base/utf8.h"
#include "retarget/rig.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

std::string system_message(int error_number) {
  return std::generic_category().message(error_number);
}

// a folder that make_robot made, as far as its robot.json tells
bool is_made_robot(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  // a link would be replaced and not what it points to
  if (!fs::is_directory(fs::symlink_status(folder, ignored))) return false;
  const fs::path profile = folder / "robot.json";
  if (!fs::is_regular_file(profile, ignored)) return false;
  const auto json = load_json(profile.string());
  if (!json || !json->is_object()) return false;
  const auto found = json->find("name");
  if (found == json->end() || !found->is_string() || found->get<std::string>() != name) {
    return false;
  }
  // what it always writes
  for (const char* key : {"source", "joint_order", "speed_limits_source", "t_pose", "soles",
                          "allowed_self_contact"}) {
    if (!json->contains(key)) return false;
  }
  return true;
}

// an empty folder of a name that nothing had; errno where there is none
int make_new_folder(const fs::path& beside, fs::path& made) {
  constexpr int kMaxNames = 1000;
  for (int number = 0; number < kMaxNames; ++number) {
    made = beside.parent_path() / ("." + beside.filename().string() + ".new-" +
                                   std::to_string(::getpid()) + "-" + std::to_string(number));
    if (::mkdir(made.c_str(), 0777) == 0) return 0;
    if (errno != EEXIST) break;
  }
  return errno;
}

// renames where nothing may be replaced; errno
int rename_to_new(const fs::path& from, const fs::path& to) {
#ifdef RENAME_NOREPLACE
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
#endif
  std::error_code ignored;
  if (fs::exists(fs::symlink_status(to, ignored))) return EEXIST;
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

// two folders change places, in one step where the file system can; errno
int exchange(const fs::path& made, const fs::path& there) {
#ifdef RENAME_EXCHANGE
  if (::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, there.c_str(), RENAME_EXCHANGE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
#endif
  // an empty folder may be replaced by a rename
  fs::path aside;
  if (const int error = make_new_folder(there, aside); error != 0) return error;
  if (::rename(there.c_str(), aside.c_str()) != 0) {
    const int error = errno;
    ::rmdir(aside.c_str());
    return error;
  }
  if (::rename(made.c_str(), there.c_str()) != 0) {
    const int error = errno;
    // back again: nothing has changed
    return ::rename(aside.c_str(), there.c_str()) == 0 ? error : errno;
  }
  return ::rename(aside.c_str(), made.c_str()) == 0 ? 0 : errno;
}

Result<void> write_files(const MadeRobot& robot, const fs::path& folder) {
  const std::map<std::string, const std::string*> files = {{"model.xml", &robot.model},
                                                           {"robot.json", &robot.profile},
                                                           {"ik.json", &robot.config},
                                                           {"decisions.md", &robot.decisions}};
  for (const auto& [file, text] : files) {
    TRY(write_file((folder / file).string(), *text));
  }
  return {};
}

Failure name_failure(const std::string& name) {
  return usage_failure("\"" + name + "\" cannot be a robot's name: it is not a valid folder name");
}

}  // namespace

Result<void> check_new_robot(const std::string& model_path, const std::string& name,
                             const fs::path& into) {
  if (name.empty() || name.starts_with('.') || valid_utf8(name) != name ||
      name.find_first_of("/\\") != std::string::npos) {
    return name_failure(name);
  }
  if (!is_below(model_path, into / name)) return {};
  return usage_failure(
      "\"" + model_path + "\" lies in the folder that would be replaced, \"" + name + "\"",
      "move the model out of it first");
}

Result<fs::path> save_robot(const MadeRobot& robot, const fs::path& into, bool force) {
  if (!is_plain_name(robot.name)) return name_failure(robot.name);
  const fs::path folder = into / robot.name;
  std::error_code error;
  if (!fs::is_directory(into, error)) {
    return usage_failure("the folder \"" + into.string() + "\" does not exist");
  }
  const bool is_there = fs::exists(fs::symlink_status(folder, error));
  if (is_there && !force) {
    return usage_failure("\"" + folder.string() + "\" already exists",
                         OPTION("force") " replaces it");
  }
  if (is_there && !is_made_robot(folder, robot.name)) {
    return usage_failure(
        "\"" + folder.string() +
            "\" is not replaced: it was not made by robots add for a robot of this name",
        "give another name, or remove it yourself");
  }
  // written beside its place, then put there in one step
  fs::path staging;
  const int made = make_new_folder(folder, staging);
  const auto give_up = [&](const std::string& what) {
    std::error_code ignored;
    fs::remove_all(staging, ignored);
    return run_failure(folder.string(), "cannot write the robot's folder: " + what);
  };
  if (made != 0) {
    staging.clear();
    return give_up(system_message(made));
  }
  if (auto written = write_files(robot, staging); !written) return give_up(written.error().message);
  const int placed = is_there ? exchange(staging, folder) : rename_to_new(staging, folder);
  if (placed != 0) return give_up(system_message(placed));
  // what was there before
  if (is_there) fs::remove_all(staging, error);
  return folder;
}

}  // namespace retarget
