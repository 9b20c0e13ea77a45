// `retarget robots`: lists, shows and checks robots, and makes new ones.

#include <algorithm>
#include <filesystem>

#include "base/file.h"
#include "base/printable.h"
#include "base/try.h"
#include "commands.h"
#include "retarget/rig.h"
#include "robot/find_robot.h"
#include "robot_mapping.h"
#include "run_setup.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

// with the mappings that lie beside it and in the data folder
RobotSources with_mappings(const fs::path& model, const fs::path& profile,
                           const fs::path& data_folder) {
  const fs::path named = model.parent_path();
  const fs::path folder = named.empty() ? fs::path(".") : named;
  const auto found =
      find_mappings({}, "gmr", folder, data_folder, fs::absolute(folder).filename().string());
  const MappingFiles mappings = found.value_or(MappingFiles{});
  return {{}, model.string(), profile.string(), mappings.of_lafan1, mappings.of_others};
}

Result<RobotSources> find_sources(const std::string& robot, const fs::path& data_folder) {
  TRY_ASSIGN(const auto files, find_robot(robot, data_folder / "robots"));
  return with_mappings(files.model, files.profile, data_folder);
}

Result<ExitCode> list_or_show(const RobotsOptions& options) {
  TRY_ASSIGN(const auto data_folder, data_folder_of(options.common));
  const TextForm form = options.json ? TextForm::kJson : TextForm::kPlain;
  const bool shows = options.action == RobotsAction::kShow;
  std::vector<RobotSources> robots;
  for (const std::string& name :
       shows ? std::vector{options.robot} : list_robots(data_folder / "robots")) {
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
Result<std::vector<RobotFinding>> examine(const RobotsOptions& options) {
  TRY_ASSIGN(const auto data_folder, data_folder_of(options.common));
  const fs::path model = options.robot;
  if ((model.extension() == ".xml" || model.extension() == ".urdf") && is_file(model)) {
    const fs::path profile = model.parent_path() / "robot.json";
    return check_robot(with_mappings(model, is_file(profile) ? profile : fs::path(), data_folder),
                       option_as_flag);
  }
  TRY_ASSIGN(const auto robot, find_sources(options.robot, data_folder));
  return check_robot(robot, option_as_flag);
}

Result<ExitCode> check(const RobotsOptions& options) {
  TRY_ASSIGN(const auto findings, examine(options));
  std::string text;
  for (const RobotFinding& finding : findings) {
    text += (finding.fault ? "fault: " : "note: ") + finding.text + "\n";
  }
  const auto faults = std::ranges::count(findings, true, &RobotFinding::fault);
  const auto notes = static_cast<long>(findings.size()) - faults;
  text +=
      options.robot + ": " + count_text(faults, "fault") + ", " + count_text(notes, "note") + "\n";
  TRY(write_file("-", printable(text)));
  return faults > 0 ? kBadConfig : kDone;
}

Result<ExitCode> add(const RobotsOptions& options, Console& console) {
  TRY(check_new_robot(options.model, options.robot, options.output));
  TRY_ASSIGN(const auto made, make_robot(options.model, options.robot));
  for (const std::string& line : made.summary) {
    const std::size_t colon = line.find(": ");
    console.line(line.substr(0, colon), line.substr(colon + 2));
  }
  for (const std::string& note : made.notes) console.warn({{0, 0, note}}, options.model);
  TRY_ASSIGN(const auto folder, save_robot(made, options.output, options.force));
  console.line("wrote", folder.string() + "; decisions.md says what was decided");
  return kDone;
}

}  // namespace

ExitCode robots(const RobotsOptions& options, Console& console) {
  const auto done = options.action == RobotsAction::kAdd     ? add(options, console)
                    : options.action == RobotsAction::kCheck ? check(options)
                                                             : list_or_show(options);
  return done ? *done : console.fail(done.error());
}

}  // namespace retarget::cli
