// `retarget robots`: lists, shows and checks robots, and adds new ones.

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/options.h"
#include "retarget/rig.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "rig/install_robots.h"
#include "robot/model/find_robot.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

// Adds the configurations next to the model and in the data folder.
RobotSources with_configs(const fs::path& model, const fs::path& profile,
                          const std::string& data_folder) {
  const fs::path named = model.parent_path();
  const fs::path folder = named.empty() ? fs::path(".") : named;
  const auto found =
      find_configs({}, Method::kGmr, folder, data_folder, fs::absolute(folder).filename().string());
  const ConfigFiles configs = found.value_or(ConfigFiles{});
  return {{}, model.string(), profile.string(), configs.of_lafan1, configs.of_others};
}

Result<RobotSources> find_sources(const std::string& robot, const std::string& data_folder) {
  RETARGET_TRY_ASSIGN(const auto files, find_robot(robot, robot_folders(data_folder)));
  return with_configs(files.model, files.profile, data_folder);
}

// Inserts known robots that are not installed into the sorted list.
Result<void> append_left_out(const RobotFolders& folders, const std::vector<std::string>& installed,
                             std::vector<RobotSources>& robots) {
  RETARGET_TRY_ASSIGN(const auto known, known_robots(folders));
  for (const KnownRobot& robot : known) {
    if (std::ranges::find(installed, robot.name) != installed.end()) continue;
    RobotSources left_out;
    left_out.name = robot.name;
    left_out.description = robot.description;
    left_out.licence = robot.licence;
    left_out.licence_stated = robot.in_packages;
    robots.push_back(std::move(left_out));
  }
  std::ranges::sort(robots, {}, &RobotSources::name);
  return {};
}

Result<ExitCode> list_or_show(const RobotsArguments& arguments) {
  RETARGET_TRY_ASSIGN(const auto data_folder, data_folder_of(arguments.common));
  const TextForm form = arguments.json ? TextForm::kJson : TextForm::kPlain;
  const bool shows = arguments.action == RobotsAction::kShow;
  std::vector<RobotSources> robots;
  const RobotFolders folders = robot_folders(data_folder);
  const std::vector<std::string> installed = list_robots(folders);
  for (const std::string& name : shows ? std::vector{arguments.robot} : installed) {
    RETARGET_TRY_ASSIGN(auto robot, find_sources(name, data_folder));
    robot.name = name;
    robots.push_back(std::move(robot));
  }
  if (!shows) RETARGET_TRY(append_left_out(folders, installed, robots));
  RETARGET_TRY_ASSIGN(const auto text,
                      shows ? describe_robot(robots.front(), form) : describe_robots(robots, form));
  RETARGET_TRY(write_file("-", text));
  return kDone;
}

// Returns the findings for a robot or a bare model file.
Result<std::vector<RobotFinding>> examine(const RobotsArguments& arguments) {
  RETARGET_TRY_ASSIGN(const auto data_folder, data_folder_of(arguments.common));
  const fs::path model = arguments.robot;
  if ((model.extension() == ".xml" || model.extension() == ".urdf") && is_file(model)) {
    const fs::path profile = model.parent_path() / "robot.json";
    auto sources = with_configs(model, is_file(profile) ? profile : fs::path(), data_folder);
    sources.base = arguments.base;
    return check_robot(sources, option_as_flag);
  }
  RETARGET_TRY_ASSIGN(auto robot, find_sources(arguments.robot, data_folder));
  robot.base = arguments.base;
  return check_robot(robot, option_as_flag);
}

Result<ExitCode> check(const RobotsArguments& arguments) {
  RETARGET_TRY_ASSIGN(const auto findings, examine(arguments));
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

Result<ExitCode> add(const RobotsArguments& arguments, Console& console) {
  RETARGET_TRY(check_new_robot(arguments.model, arguments.robot, arguments.output));
  RETARGET_TRY_ASSIGN(const auto made,
                      make_robot(arguments.model, arguments.robot, arguments.base));
  for (const std::string& line : made.summary) {
    const std::size_t colon = line.find(": ");
    console.line(line.substr(0, colon), line.substr(colon + 2));
  }
  for (const std::string& note : made.notes) console.warn({{0, 0, note}}, arguments.model);
  RETARGET_TRY_ASSIGN(const auto folder, save_robot(made, arguments.output, arguments.force));
  console.line("wrote", folder.string() + "; decisions.md documents the decisions");
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
                       ": its maker states none; ask the maker before you distribute the model");
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
      return check(arguments);
    case RobotsAction::kList:
    case RobotsAction::kShow:
      break;
  }
  return list_or_show(arguments);
}

}  // namespace retarget::cli
