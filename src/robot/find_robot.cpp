#include "robot/find_robot.h"

#include <algorithm>
#include <cctype>
#include <system_error>

#include "base/file.h"
#include "base/lower_case.h"
#include "base/option_name.h"
#include "base/suggest.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModelFile = "model.xml";
constexpr const char* kProfileFile = "robot.json";
constexpr const char* kUnverified = "unverified";

// the words of a name: `Unitree-G1` is unitree, g1
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

// the robots that a short name may mean: those whose name ends with its words, else those that
// have them anywhere, one behind the other. So `g1` is unitree_g1 and not unitree_g1_with_hands.
std::vector<std::string> robots_called(const std::string& name,
                                       const std::vector<std::string>& known) {
  const std::vector<std::string> words = words_of(name);
  // no name, or one that is a number and so tells no robot
  if (std::ranges::none_of(name, [](unsigned char c) { return std::isalpha(c) != 0; })) return {};
  std::vector<std::string> ending, holding;
  for (const std::string& robot : known) {
    const std::vector<std::string> all = words_of(robot);
    const auto found = std::find_end(all.begin(), all.end(), words.begin(), words.end());
    if (found == all.end()) continue;
    const auto behind = all.end() - found - static_cast<std::ptrdiff_t>(words.size());
    (behind == 0 ? ending : holding).push_back(robot);
  }
  return ending.empty() ? holding : ending;
}

// a profile that cannot be looked at is none that is not there
Result<RobotFiles> files_in(const fs::path& folder, const std::string& name) {
  const fs::path profile = folder / kProfileFile;
  std::error_code error;
  if (!fs::status_known(fs::status(profile, error))) {
    return config_failure(profile.string(), "cannot access the file: " + error.message());
  }
  return RobotFiles{folder / kModelFile, is_file(profile) ? profile : fs::path(), name};
}

}  // namespace

Result<RobotFiles> find_robot(const std::string& name_or_folder, const fs::path& robots_folder) {
  const fs::path given(name_or_folder);
  if (!name_or_folder.empty()) {
    for (const fs::path& folder :
         {robots_folder / given, robots_folder / kUnverified / given, given}) {
      if (is_file(folder / kModelFile)) return files_in(folder, name_or_folder);
    }
  }
  const std::vector<std::string> known = list_robots(robots_folder);
  const std::vector<std::string> called = robots_called(name_or_folder, known);
  if (called.size() == 1) return find_robot(called.front(), robots_folder);
  if (called.size() > 1) {
    return config_failure(
        "",
        "\"" + name_or_folder + "\" may be any of the robots " + list_names(called, called.size()),
        "name one of them");
  }
  std::error_code ignored;
  if (!name_or_folder.empty() && fs::is_directory(given, ignored)) {
    return config_failure(name_or_folder,
                          std::string("the robot folder has no file ") + kModelFile);
  }
  if (is_file(given)) {
    return config_failure(
        name_or_folder, "expected a robot's name or folder, found a file",
        "a model file goes with " OPTION("robot-xml") " FILE " OPTION("ik-config") " FILE");
  }
  return config_failure(
      "", "no robot \"" + name_or_folder + "\"" + did_you_mean(name_or_folder, known),
      (known.empty() ? "there are no robots in " + robots_folder.string()
                     : "known robots: " + list_names(known)) +
          "; any other: " OPTION("robot-xml") " FILE " OPTION("ik-config") " FILE");
}

bool is_unverified(const fs::path& model) {
  return model.parent_path().parent_path().filename() == kUnverified;
}

std::vector<std::string> list_robots(const fs::path& robots_folder) {
  std::vector<std::string> names;
  for (const fs::path& folder : {robots_folder, robots_folder / kUnverified}) {
    for (const fs::path& robot : files_in_folder(folder)) {
      if (is_file(robot / kModelFile)) names.push_back(robot.filename().string());
    }
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace retarget
