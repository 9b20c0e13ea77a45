// `retarget robots`: lists, shows and checks robots, and adds new ones.

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/file.h"
#include "retarget/rig.h"
#include "retarget/robots.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

// Finds the robot that the arguments name. Warns if the name may mean another one.
Result<RobotSources> named_robot(const RobotsArguments& arguments, const std::string& data_folder,
                                 Console& console) {
  RETARGET_TRY_ASSIGN(auto robot, find_robot_sources(arguments.robot, data_folder));
  if (!robot.warning.empty()) console.warn({{0, 0, robot.warning}}, arguments.robot);
  return robot;
}

Result<ExitCode> list_or_show(const RobotsArguments& arguments, Console& console) {
  RETARGET_TRY_ASSIGN(const auto data_folder, data_folder_of(arguments.common));
  const TextForm form = arguments.json ? TextForm::kJson : TextForm::kPlain;
  std::string text;
  if (arguments.action == RobotsAction::kShow) {
    RETARGET_TRY_ASSIGN(auto robot, named_robot(arguments, data_folder, console));
    robot.name = arguments.robot;
    RETARGET_TRY_ASSIGN(text, describe_robot(robot, form));
  } else {
    RETARGET_TRY_ASSIGN(const auto robots, list_robot_sources(data_folder));
    RETARGET_TRY_ASSIGN(text, describe_robots(robots, form));
  }
  RETARGET_TRY(write_file("-", text));
  return kDone;
}

// Returns the findings for a robot or a bare model file.
Result<std::vector<RobotFinding>> examine(const RobotsArguments& arguments, Console& console) {
  RETARGET_TRY_ASSIGN(const auto data_folder, data_folder_of(arguments.common));
  const fs::path model = arguments.robot;
  if ((model.extension() == ".xml" || model.extension() == ".urdf") && is_file(model)) {
    RobotSources sources = sources_of_model(model, data_folder);
    sources.base = arguments.base;
    return check_robot(sources, option_as_flag);
  }
  RETARGET_TRY_ASSIGN(auto robot, named_robot(arguments, data_folder, console));
  robot.base = arguments.base;
  return check_robot(robot, option_as_flag);
}

Result<ExitCode> check(const RobotsArguments& arguments, Console& console) {
  RETARGET_TRY_ASSIGN(const auto findings, examine(arguments, console));
  std::string text;
  for (const RobotFinding& finding : findings) {
    text += (finding.fault ? "error: " : "note: ") + finding.text + "\n";
  }
  const auto faults = std::ranges::count(findings, true, &RobotFinding::fault);
  const auto notes = static_cast<long>(findings.size()) - faults;
  text += arguments.robot + ": " + count_text(faults, "error") + ", " + count_text(notes, "note") +
          "\n";
  RETARGET_TRY(write_file("-", printable(text)));
  return faults > 0 ? kBadConfig : kDone;
}

Result<ExitCode> compare(const RobotsArguments& arguments, Console& console) {
  RETARGET_TRY_ASSIGN(const auto data_folder, data_folder_of(arguments.common));
  RETARGET_TRY_ASSIGN(const auto robot, named_robot(arguments, data_folder, console));
  RETARGET_TRY_ASSIGN(const auto differences, compare_robot(robot, arguments.model));
  std::string text;
  for (const std::string& line : differences) text += line + "\n";
  if (differences.empty()) text = "joints, axes, ranges, body positions and masses are equal\n";
  RETARGET_TRY(write_file("-", printable(text)));
  return differences.empty() ? kDone : kRunFailed;
}

// Whether the name of a new robot's folder selects another, installed robot.
bool has_namesake(const fs::path& folder, const RobotsArguments& arguments) {
  // A model can be added without a data folder.
  const auto data_folder = data_folder_of(arguments.common);
  if (!data_folder) return false;
  const RobotFolders folders = robot_folders(*data_folder);
  const std::string name = folder.filename().string();
  if (std::ranges::count(list_robots(folders), name) == 0) return false;
  const auto installed = find_robot(name, folders);
  std::error_code ignored;
  return installed && !fs::equivalent(installed->model, folder / "model.xml", ignored);
}

Result<ExitCode> add(const RobotsArguments& arguments, Console& console) {
  RETARGET_TRY(
      check_new_robot(arguments.model, arguments.robot, arguments.output, arguments.force));
  RETARGET_TRY_ASSIGN(const auto made,
                      make_robot(arguments.model, arguments.robot, arguments.base));
  for (const std::string& line : made.summary) {
    const std::size_t colon = line.find(": ");
    console.line(line.substr(0, colon), line.substr(colon + 2));
  }
  for (const std::string& note : made.notes) console.warn({{0, 0, note}}, arguments.model);
  RETARGET_TRY_ASSIGN(const auto folder, save_robot(made, arguments.output, arguments.force));
  console.line("wrote", folder.string() + "; decisions.md documents the decisions");
  if (has_namesake(folder, arguments)) {
    console.warn({{0, 0,
                   "an installed robot has the same name: select yours by its path, " +
                       (folder.has_parent_path() ? folder : "." / folder).string()}},
                 arguments.model);
  }
  return kDone;
}

Result<ExitCode> install(const RobotsArguments& arguments, Console& console) {
  RETARGET_TRY_ASSIGN(const auto data_folder, data_folder_of(arguments.common));
  RobotsToInstall request;
  request.names = arguments.names;
  request.source = arguments.source;
  request.into = arguments.install_folder;
  request.replace = arguments.force;
  request.installed = list_robots(robot_folders(data_folder));
  RETARGET_TRY_ASSIGN(const auto folders, install_robots(request));
  for (const fs::path& folder : folders) {
    console.line("wrote", folder.string());
    if (is_unverified(folder / "model.xml")) {
      console.line("licence",
                   folder.filename().string() +
                       ": the maker states none; ask the maker before you distribute the model");
    }
  }
  if (folders.empty()) console.line("", "all robots in " + arguments.source + " are installed");
  return kDone;
}

}  // namespace

Result<ExitCode> robots(const RobotsArguments& arguments, Console& console) {
  switch (arguments.action) {
    case RobotsAction::kAdd:
      return add(arguments, console);
    case RobotsAction::kInstall:
      return install(arguments, console);
    case RobotsAction::kCheck:
      return check(arguments, console);
    case RobotsAction::kCompare:
      return compare(arguments, console);
    case RobotsAction::kList:
    case RobotsAction::kShow:
      break;
  }
  return list_or_show(arguments, console);
}

}  // namespace retarget::cli
