#include "retarget/load_robot.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/faults.h"
#include "base/json.h"
#include "base/option_name.h"
#include "base/try.h"
#include "retarget/data_folder.h"
#include "retarget/file.h"
#include "retarget/text.h"
#include "robot/model/load_model.h"
#include "robot/model/load_profile.h"

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
  return RobotFiles{folder / kModelFile, is_file(profile) ? profile : fs::path(), name, {}};
}

// The folder of an installed robot. A path with a separator, such as ./unitree_g1, never names one.
std::optional<fs::path> folder_of_installed(const fs::path& name, const RobotFolders& folders) {
  if (name.empty() || name.has_parent_path()) return std::nullopt;
  for (const fs::path& robots : folders) {
    for (const fs::path& folder : {robots / name, robots / kUnverified / name}) {
      if (is_file(folder / kModelFile)) return folder;
    }
  }
  return std::nullopt;
}

// Warns of another robot in the current folder with the name of an installed one.
std::string warning_of_folder(const RobotFiles& installed) {
  const fs::path here = fs::path(".") / installed.name / kModelFile;
  std::error_code ignored;
  if (!is_file(here) || fs::equivalent(here, installed.model, ignored)) return {};
  return "using the installed robot " + installed.name + ", not the folder of that name here: ./" +
         installed.name + " selects it";
}

// Warns if the name of a folder is also the short name of a known robot.
std::string warning_of_short_name(const fs::path& folder, const RobotFolders& folders) {
  if (folder.has_parent_path()) return {};
  const auto names = names_in(folders);
  if (!names) return {};
  const std::vector<std::string> called = robots_called(folder.string(), names->all);
  if (called.size() != 1 || called.front() == folder) return {};
  return "using the folder " + folder.string() + " here, not the robot " + called.front() +
         ": its full name selects it";
}

}  // namespace

std::string install_hint(const std::string& robot) {
  return "retarget robots install " + robot + " " OPTION(
             "source") " SOURCE installs it from the source tree or from "
         "retarget-robots-unverified.zip (docs/robots.md)";
}

Result<RobotFiles> find_robot(const std::string& name_or_folder, const RobotFolders& folders) {
  const fs::path given(name_or_folder);
  if (const auto folder = folder_of_installed(given, folders)) {
    TRY_ASSIGN(RobotFiles files, files_in(*folder, name_or_folder));
    files.warning = warning_of_folder(files);
    return files;
  }
  if (!name_or_folder.empty() && is_file(given / kModelFile)) {
    TRY_ASSIGN(RobotFiles files, files_in(given, name_or_folder));
    files.warning = warning_of_short_name(given, folders);
    return files;
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

namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string> kIndexKeys = {"name", "description", "licence", "in_packages"};

Result<void> append_index(const fs::path& path, std::vector<KnownRobot>& known) {
  TRY_ASSIGN(const Json json, load_json(path.string()));
  Faults faults;
  const Json* robots = nullptr;
  if (json.is_object()) robots = JsonMembers(json, faults).list("robots");
  if (robots == nullptr) faults.add("expected {\"robots\": [{\"name\": text, ...}, ...]}");
  for (const Json& entry : robots == nullptr ? Json::array() : *robots) {
    if (!entry.is_object()) {
      faults.add("a robot must be an object, found " + short_text(entry));
      continue;
    }
    const JsonMembers members(entry, faults);
    members.check_keys(kIndexKeys);
    KnownRobot robot{members.text("name"), members.text("description"), members.text("licence"),
                     members.flag("in_packages")};
    if (robot.name.empty()) faults.add("a robot has no name");
    if (std::ranges::count(known, robot.name, &KnownRobot::name) > 0) continue;
    known.push_back(std::move(robot));
  }
  if (!faults.empty()) return faults.failure_in(path.string(), "the index of the robots");
  return {};
}

}  // namespace

RobotFolders robot_folders(const fs::path& data_folder) {
  RobotFolders folders = {data_folder / "robots"};
  if (const auto own = user_data_folder()) folders.push_back(*own / "robots");
  return folders;
}

Result<std::vector<KnownRobot>> known_robots(const RobotFolders& folders) {
  std::vector<KnownRobot> known;
  for (const fs::path& folder : folders) {
    if (is_file(folder / "index.json")) TRY(append_index(folder / "index.json", known));
  }
  std::ranges::sort(known, {}, &KnownRobot::name);
  return known;
}

Result<std::shared_ptr<const Robot>> load_robot_files(const std::string& model_path,
                                                      const std::string& profile_path,
                                                      RobotBase base) {
  const bool fixed =
      base == RobotBase::kFixed || (!profile_path.empty() && states_fixed_base(profile_path));
  ModelChanges changes;
  changes.float_base = fixed;
  TRY_ASSIGN(auto loaded, load_model(model_path, changes));
  TRY(check_robot_joints(*loaded.model, model_path));
  RobotProfile bare;
  bare.name = std::filesystem::path(model_path).stem().string();
  // The stem of a file such as `...xml` is not a usable folder name.
  if (!is_plain_name(bare.name)) bare.name = "model";
  bare.coupled_joints = std::move(loaded.couplings);
  bare.fixed_base = fixed;
  auto robot =
      std::make_shared<Robot>(std::move(loaded.model), std::move(bare), std::move(loaded.warnings));
  if (profile_path.empty()) return robot;
  TRY_ASSIGN(auto profile, load_profile(profile_path, *robot));
  if (profile.coupled_joints.empty()) profile.coupled_joints = robot->profile().coupled_joints;
  if (fixed) {
    profile.fixed_base = true;
    profile.soles.clear();
  }
  robot->set_profile(std::move(profile));
  return robot;
}

}  // namespace retarget
