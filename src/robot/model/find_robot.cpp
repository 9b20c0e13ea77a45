#include "retarget/robots.h"

#include <algorithm>
#include <cctype>
#include <system_error>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModelFile = "model.xml";
constexpr const char* kProfileFile = "robot.json";
constexpr const char* kUnverified = "unverified";

// Splits a name into lower-case words: `Unitree-G1` becomes unitree, g1.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words = {{}};
  for (const char c : lower_case(name)) {
    if (c == '_' || c == '-' || c == ' ') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

bool is_among(const std::string& name, const std::vector<std::string>& names) {
  return std::ranges::find(names, name) != names.end();
}

// Returns the robots that a name may refer to. A full name, in any letter case, matches that robot
// alone. A short name matches the robots whose names end with its words, otherwise those that
// contain them consecutively: `g1` matches unitree_g1 but not unitree_g1_with_hands.
std::vector<std::string> robots_called(const std::string& name,
                                       const std::vector<std::string>& known) {
  const std::vector<std::string> words = words_of(name);
  // A number alone does not identify a robot.
  if (std::ranges::none_of(name, [](unsigned char c) { return std::isalpha(c) != 0; })) return {};
  std::vector<std::string> ending, holding;
  for (const std::string& robot : known) {
    const std::vector<std::string> all = words_of(robot);
    if (all == words) return {robot};
    const auto found = std::find_end(all.begin(), all.end(), words.begin(), words.end());
    if (found == all.end()) continue;
    const auto behind = all.end() - found - static_cast<std::ptrdiff_t>(words.size());
    (behind == 0 ? ending : holding).push_back(robot);
  }
  return ending.empty() ? holding : ending;
}

// Names of the installed robots and of all known ones.
struct Names {
  std::vector<std::string> installed;
  std::vector<KnownRobot> known;
  std::vector<std::string> all;
};

Result<Names> names_in(const RobotFolders& folders) {
  Names names;
  names.installed = list_robots(folders);
  TRY_ASSIGN(names.known, known_robots(folders));
  names.all = names.installed;
  for (const KnownRobot& robot : names.known) {
    if (!is_among(robot.name, names.installed)) names.all.push_back(robot.name);
  }
  std::ranges::sort(names.all);
  return names;
}

Failure not_installed(const std::string& robot, const Names& names) {
  const auto known = std::ranges::find(names.known, robot, &KnownRobot::name);
  const bool left_out = known != names.known.end() && !known->in_packages;
  return config_failure(
      "",
      "the robot " + robot + " is not installed" +
          (left_out ? ": its maker states no licence, so packages do not include it" : ""),
      install_hint(robot));
}

Failure ambiguous(const std::string& name, std::vector<std::string> called, const Names& names) {
  for (std::string& robot : called) {
    if (!is_among(robot, names.installed)) robot += " (not installed)";
  }
  return config_failure(
      "",
      "\"" + name + "\" is ambiguous: it matches the robots " + list_names(called, called.size()),
      "give one of these names");
}

// A profile that cannot be accessed is an error, not a missing profile.
Result<RobotFiles> files_in(const fs::path& folder, const std::string& name) {
  const fs::path profile = folder / kProfileFile;
  std::error_code error;
  if (!fs::status_known(fs::status(profile, error))) {
    return config_failure(profile.string(), "cannot access the file: " + error.message());
  }
  return RobotFiles{folder / kModelFile, is_file(profile) ? profile : fs::path(), name};
}

}  // namespace

std::string install_hint(const std::string& robot) {
  return "retarget robots install " + robot + " " OPTION(
             "source") " SOURCE installs it from the source tree or from "
         "retarget-robots-unverified.zip (docs/robots.md)";
}

Result<RobotFiles> find_robot(const std::string& name_or_folder, const RobotFolders& folders) {
  const fs::path given(name_or_folder);
  if (!name_or_folder.empty()) {
    for (const fs::path& robots : folders) {
      for (const fs::path& folder : {robots / given, robots / kUnverified / given}) {
        if (is_file(folder / kModelFile)) return files_in(folder, name_or_folder);
      }
    }
    if (is_file(given / kModelFile)) return files_in(given, name_or_folder);
  }
  TRY_ASSIGN(const Names names, names_in(folders));
  const std::vector<std::string> called = robots_called(name_or_folder, names.all);
  if (called.size() > 1) return ambiguous(name_or_folder, called, names);
  if (called.size() == 1) {
    if (!is_among(called.front(), names.installed)) return not_installed(called.front(), names);
    return find_robot(called.front(), folders);
  }
  std::error_code ignored;
  if (!name_or_folder.empty() && fs::is_directory(given, ignored)) {
    return config_failure(name_or_folder,
                          std::string("the robot folder has no file ") + kModelFile);
  }
  if (is_file(given)) {
    return config_failure(
        name_or_folder, "expected a robot name or folder, found a file",
        "give a model file with " OPTION("robot-xml") " FILE " OPTION("ik-config") " FILE");
  }
  return config_failure(
      "", "no robot \"" + name_or_folder + "\"" + did_you_mean(name_or_folder, names.all),
      (names.installed.empty()
           ? "there are no robots in " + (folders.empty() ? "" : folders.front().string())
           : "known robots: " + list_names(names.installed)) +
          "; any other: " OPTION("robot-xml") " FILE " OPTION("ik-config") " FILE");
}

bool names_robot(const std::string& name_or_folder, const RobotFolders& folders) {
  if (find_robot(name_or_folder, folders)) return true;
  const auto names = names_in(folders);
  return names && robots_called(name_or_folder, names->all).size() == 1;
}

bool is_unverified(const fs::path& model) {
  return model.parent_path().parent_path().filename() == kUnverified;
}

std::vector<std::string> list_robots(const RobotFolders& folders) {
  std::vector<std::string> names;
  for (const fs::path& robots : folders) {
    for (const fs::path& folder : {robots, robots / kUnverified}) {
      for (const fs::path& robot : files_in_folder(folder)) {
        if (is_file(robot / kModelFile)) names.push_back(robot.filename().string());
      }
    }
  }
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace retarget
