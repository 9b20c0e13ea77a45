#include "retarget/rig.h"

#include <algorithm>
#include <cerrno>
#include <functional>
#include <map>
#include <system_error>
#include <utility>

#include "retarget/data_folder.h"
#include "retarget/file.h"
#include "retarget/json.h"
#include "retarget/load_robot.h"
#include "retarget/option_name.h"
#include "retarget/os.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "retarget/zip.h"

namespace retarget {
namespace {

// The files of a robot's folder: text by file name.
using FileTexts = std::map<std::string, std::string>;

// Controls how put_robot_folder treats existing files.
struct PutOptions {
  bool replace = false;  // Replace an existing folder if `may_replace` accepts it.
  std::function<bool(const std::filesystem::path&)> may_replace;
  std::string otherwise;  // Explains in the message why a folder is not replaced.
  // Checks the files after they are written; empty: no check. An error of kind kConfig is returned
  // unchanged and nothing is left behind.
  std::function<Result<void>(const std::filesystem::path&)> check;
};

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

// Checks that a text is a valid name for a robot and its folder. Errors: kUsage.
Result<void> check_robot_name(const std::string& name) {
  const bool valid = is_plain_name(name) && !name.starts_with('.') && valid_utf8(name) == name &&
                     name.find_first_of("/\\") == std::string::npos;
  if (valid) return {};
  return usage_failure("\"" + name +
                       "\" is not a valid robot name: it must be a valid folder name");
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path.empty() ? fs::path(".") : path, ignored);
}

// The parent of the folder may be missing, but not the parent's parent.
Result<void> check_place(const fs::path& folder, const PutOptions& options) {
  const fs::path into = folder.parent_path();
  if (!is_folder(into)) {
    std::error_code ignored;
    if (fs::exists(into, ignored)) {
      return usage_failure("\"" + into.string() + "\" is not a folder");
    }
    if (!is_folder(into.parent_path())) {
      return usage_failure("the folder \"" + into.parent_path().string() + "\" does not exist");
    }
  }
  std::error_code error;
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

// Writes a robot's folder atomically: completely or not at all. Creates its parent if necessary.
// Errors: those of check_place; kRun.
Result<void> put_robot_folder(const fs::path& folder, const FileTexts& files,
                              const PutOptions& options) {
  RETARGET_TRY(check_place(folder, options));
  std::error_code error;
  const bool is_there = fs::exists(fs::symlink_status(folder, error));
  if (!is_folder(folder.parent_path())) fs::create_directory(folder.parent_path(), error);
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

constexpr const char* kModelFile = "model.xml";
constexpr const char* kProfileFile = "robot.json";
constexpr const char* kUnverified = "unverified";
// Well above the size of any model's text.
constexpr std::size_t kMaxFile = std::size_t{16} << 20U;
constexpr std::size_t kMaxArchive = std::size_t{1} << 30U;
constexpr std::size_t kMaxUnpacked = std::size_t{256} << 20U;

struct RobotInSource {
  FileTexts files;
  bool unverified = false;
};

using RobotsInSource = std::map<std::string, RobotInSource>;

Failure source_failure(const fs::path& source, const std::string& message) {
  return usage_failure("\"" + source.string() + "\": " + message,
                       RETARGET_OPTION("source") " must be the source tree of retarget or "
                       "retarget-robots-unverified.zip from tools/release.sh");
}

Result<RobotInSource> read_folder(const fs::path& folder) {
  RobotInSource robot;
  robot.unverified = folder.parent_path().filename() == kUnverified;
  for (const fs::path& file : files_in_folder(folder)) {
    if (!is_file(file)) continue;
    RETARGET_TRY_ASSIGN(const FileContent content,
                        read_file(file.string(), ErrorKind::kConfig, kMaxFile));
    robot.files[file.filename().string()] = content.view();
  }
  return robot;
}

Result<RobotsInSource> robots_in_folder(const fs::path& source) {
  RobotsInSource found;
  for (const fs::path& robots :
       {source / "robots", source / "robots" / kUnverified, source / kUnverified, source}) {
    for (const fs::path& folder : files_in_folder(robots)) {
      const std::string name = folder.filename().string();
      if (!is_file(folder / kModelFile) || found.contains(name)) continue;
      RETARGET_TRY_ASSIGN(found[name], read_folder(folder));
    }
  }
  return found;
}

// Matches `X/robots/NAME/FILE` and `X/unverified/NAME/FILE`.
bool is_robots_file(const fs::path& path) {
  const fs::path above = path.parent_path().parent_path().filename();
  return path.has_filename() && (above == "robots" || above == kUnverified);
}

Result<std::string> unpacked(const ZipArchive& archive, std::size_t index) {
  const ZipEntry& entry = archive.entries()[index];
  if (entry.size > kMaxFile) return config_failure("", "\"" + entry.name + "\" is too large");
  RETARGET_TRY_ASSIGN(ZipEntryReader reader, archive.entry_reader(index));
  RETARGET_TRY_ASSIGN(std::string bytes, reader.read(static_cast<std::size_t>(entry.size)));
  RETARGET_TRY(reader.finish());
  return bytes;
}

Result<RobotsInSource> robots_in_archive(const fs::path& source) {
  RETARGET_TRY_ASSIGN(const FileContent content,
                      read_file(source.string(), ErrorKind::kUsage, kMaxArchive));
  const auto archive = ZipArchive::open(content.view());
  if (!archive) return source_failure(source, "neither a folder nor a ZIP archive");
  RobotsInSource found;
  std::size_t all = 0;
  for (std::size_t i = 0; i < archive->entries().size(); ++i) {
    const fs::path path(archive->entries()[i].name);
    if (!is_robots_file(path)) continue;
    auto text = unpacked(*archive, i);
    if (!text) return config_failure(source.string(), text.error().message, text.error().hint);
    all += text->size();
    if (all > kMaxUnpacked) return config_failure(source.string(), "its robots are too large");
    RobotInSource& robot = found[path.parent_path().filename().string()];
    robot.unverified = path.parent_path().parent_path().filename() == kUnverified;
    robot.files[path.filename().string()] = *std::move(text);
  }
  std::erase_if(found, [](const auto& robot) { return !robot.second.files.contains(kModelFile); });
  return found;
}

Result<std::vector<std::string>> chosen_names(const RobotsToInstall& request,
                                              const RobotsInSource& found) {
  std::vector<std::string> there;
  for (const auto& [name, robot] : found) there.push_back(name);
  if (there.empty()) return source_failure(request.source, "no robots in it");
  for (const std::string& name : request.names) {
    if (found.contains(name)) continue;
    return usage_failure("\"" + request.source.string() + "\" has no robot \"" + name + "\"" +
                             did_you_mean(name, there),
                         "its robots: " + list_names(there));
  }
  if (!request.names.empty()) return request.names;
  std::erase_if(there, [&](const std::string& name) {
    return std::ranges::find(request.installed, name) != request.installed.end();
  });
  return there;
}

Result<fs::path> folder_for(const RobotsToInstall& request, bool unverified) {
  if (!request.into.empty()) return request.into;
  const auto own = user_data_folder();
  if (!own) {
    return usage_failure("the folder of your own robots is unknown: HOME is not set",
                         RETARGET_OPTION("output") " DIR selects a folder");
  }
  const fs::path folder = unverified ? *own / "robots" / kUnverified : *own / "robots";
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return run_failure(folder.string(), "cannot create the folder: " + error.message());
  return folder;
}

Result<void> check_loads(const fs::path& folder, const std::string& name) {
  const fs::path profile = folder / kProfileFile;
  RETARGET_TRY_ASSIGN(const auto robot,
                      load_robot_files((folder / kModelFile).string(),
                                       is_file(profile) ? profile.string() : std::string()));
  if (!is_file(profile) || robot->name() == name) return {};
  return config_failure(name, "its robot.json names the robot \"" + robot->name() + "\"");
}

}  // namespace

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

Result<std::vector<fs::path>> install_robots(const RobotsToInstall& request) {
  std::error_code ignored;
  const bool is_folder = fs::is_directory(request.source, ignored);
  RETARGET_TRY_ASSIGN(const RobotsInSource found, is_folder ? robots_in_folder(request.source)
                                                            : robots_in_archive(request.source));
  RETARGET_TRY_ASSIGN(const std::vector<std::string> names, chosen_names(request, found));
  std::vector<fs::path> installed;
  for (const std::string& name : names) {
    RETARGET_TRY(check_robot_name(name));
    const RobotInSource& robot = found.at(name);
    RETARGET_TRY_ASSIGN(const fs::path into, folder_for(request, robot.unverified));
    PutOptions options;
    options.replace = request.replace;
    options.may_replace = [](const fs::path& there) { return is_file(there / kModelFile); };
    options.otherwise = "it is not a robot folder";
    options.check = [&](const fs::path& folder) { return check_loads(folder, name); };
    RETARGET_TRY(put_robot_folder(into / name, robot.files, options));
    installed.push_back(into / name);
  }
  return installed;
}

}  // namespace retarget
