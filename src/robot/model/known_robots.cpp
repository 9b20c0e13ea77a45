#include "retarget/robots.h"

#include <algorithm>
#include <utility>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/data_folder.h"
#include "retarget/file.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
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

}  // namespace retarget
