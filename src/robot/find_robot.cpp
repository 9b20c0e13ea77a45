#include "retarget/robot/find_robot.h"

#include <algorithm>
#include <cctype>
#include <system_error>

#include "retarget/base/suggest.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModelFile = "model.xml";
constexpr const char* kProfileFile = "robot.json";

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// `g1` is no typing mistake for `unitree_g1`, but what is meant is plain if only one name has it, or
// all that have it begin with the same one
std::string suggestion(const std::string& name, const std::vector<std::string>& known) {
  std::string near = did_you_mean(name, known);
  if (!near.empty() || name.empty()) return near;
  std::vector<std::string> containing;
  for (const std::string& robot : known) {
    if (robot.find(lower_case(name)) != std::string::npos) containing.push_back(robot);
  }
  if (containing.empty()) return {};
  const auto shortest = std::ranges::min_element(containing, {}, &std::string::size);
  const bool plain = std::ranges::all_of(
      containing, [&](const std::string& robot) { return robot.starts_with(*shortest); });
  return plain ? did_you_mean(*shortest, containing) : std::string();
}

}  // namespace

Result<RobotFiles> find_robot(const std::string& name_or_folder, const fs::path& robots_folder) {
  const fs::path given(name_or_folder);
  if (!name_or_folder.empty()) {
    for (const fs::path& folder : {robots_folder / given, given}) {
      if (!is_file(folder / kModelFile)) continue;
      const fs::path profile = folder / kProfileFile;
      return RobotFiles{folder / kModelFile, is_file(profile) ? profile : fs::path()};
    }
  }
  std::error_code ignored;
  if (!name_or_folder.empty() && fs::is_directory(given, ignored)) {
    return config_failure(name_or_folder,
                          std::string("the robot folder has no file ") + kModelFile);
  }
  if (is_file(given)) {
    return config_failure(name_or_folder, "expected a robot's name or folder, found a file",
                          "a model file goes with --robot-xml FILE --ik-config FILE");
  }
  const std::vector<std::string> known = list_robots(robots_folder);
  return config_failure("",
                        "no robot \"" + name_or_folder + "\"" + suggestion(name_or_folder, known),
                        (known.empty() ? "there are no robots in " + robots_folder.string()
                                       : "known robots: " + list_names(known)) +
                            "; any other: --robot-xml FILE --ik-config FILE");
}

std::vector<std::string> list_robots(const fs::path& robots_folder) {
  std::vector<std::string> names;
  std::error_code error;
  const fs::directory_iterator end;
  for (fs::directory_iterator entry(robots_folder, error); !error && entry != end;
       entry.increment(error)) {
    if (is_file(entry->path() / kModelFile)) names.push_back(entry->path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace retarget
