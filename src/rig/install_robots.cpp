#include "retarget/rig.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "retarget/data_folder.h"
#include "retarget/file.h"
#include "retarget/load_robot.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "retarget/zip.h"
#include "rig/robot_folder.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

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
