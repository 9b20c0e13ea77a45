// `retarget robots`: lists, shows and checks robots, and makes new ones.

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "base/file.h"
#include "base/printable.h"
#include "base/try.h"
#include "commands.h"
#include "console.h"
#include "plan/config_files.h"
#include "retarget/options.h"
#include "retarget/rig.h"
#include "robot/find_robot.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

// with the configurations that lie beside it and in the data folder
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
  TRY_ASSIGN(const auto files, find_robot(robot, fs::path(data_folder) / "robots"));
  return with_configs(files.model, files.profile, data_folder);
}

Result<ExitCode> list_or_show(const RobotsArguments& arguments) {
  TRY_ASSIGN(const auto data_folder, data_folder_of(arguments.common));
  const TextForm form = arguments.json ? TextForm::kJson : TextForm::kPlain;
  const bool shows = arguments.action == RobotsAction::kShow;
  std::vector<RobotSources> robots;
  for (const std::string& name :
       shows ? std::vector{arguments.robot} : list_robots(fs::path(data_folder) / "robots")) {
    TRY_ASSIGN(auto robot, find_sources(name, data_folder));
    robot.name = name;
    robots.push_back(std::move(robot));
  }
  TRY_ASSIGN(const auto text,
             shows ? describe_robot(robots.front(), form) : describe_robots(robots, form));
  TRY(write_file("-", text));
  return kDone;
}

// what is wrong, of a model file as well
Result<std::vector<RobotFinding>> examine(const RobotsArguments& arguments) {
  TRY_ASSIGN(const auto data_folder, data_folder_of(arguments.common));
  const fs::path model = arguments.robot;
  if ((model.extension() == ".xml" || model.extension() == ".urdf") && is_file(model)) {
    const fs::path profile = model.parent_path() / "robot.json";
    auto sources = with_configs(model, is_file(profile) ? profile : fs::path(), data_folder);
    sources.base = arguments.base;
    return check_robot(sources, option_as_flag);
  }
  TRY_ASSIGN(auto robot, find_sources(arguments.robot, data_folder));
  robot.base = arguments.base;
  return check_robot(robot, option_as_flag);
}

Result<ExitCode> check(const RobotsArguments& arguments) {
  TRY_ASSIGN(const auto findings, examine(arguments));
  std::string text;
  for (const RobotFinding& finding : findings) {
    text += (finding.fault ? "error: " : "note: ") + finding.text + "\n";
  }
  const auto faults = std::ranges::count(findings, true, &RobotFinding::fault);
  const auto notes = static_cast<long>(findings.size()) - faults;
  text += arguments.robot + ": " + count_text(faults, "error") + ", " + count_text(notes, "note") +
          "\n";
  TRY(write_file("-", printable(text)));
  return faults > 0 ? kBadConfig : kDone;
}

Result<ExitCode> add(const RobotsArguments& arguments, Console& console) {
  TRY(check_new_robot(arguments.model, arguments.robot, arguments.output));
  TRY_ASSIGN(const auto made, make_robot(arguments.model, arguments.robot, arguments.base));
  for (const std::string& line : made.summary) {
    const std::size_t colon = line.find(": ");
    console.line(line.substr(0, colon), line.substr(colon + 2));
  }
  for (const std::string& note : made.notes) console.warn({{0, 0, note}}, arguments.model);
  TRY_ASSIGN(const auto folder, save_robot(made, arguments.output, arguments.force));
  console.line("wrote", folder.string() + "; decisions.md lists the decisions");
  return kDone;
}

}  // namespace

Result<ExitCode> robots(const RobotsArguments& arguments, Console& console) {
  return arguments.action == RobotsAction::kAdd     ? add(arguments, console)
         : arguments.action == RobotsAction::kCheck ? check(arguments)
                                                    : list_or_show(arguments);
}

}  // namespace retarget::cli
