// Checks a robot with all of its files.

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "retarget/json.h"
#include "retarget/load_robot.h"
#include "retarget/make_robot.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "retarget/try.h"
#include "robot/anatomy/limbs.h"
#include "robot/anatomy/shapes.h"
#include "robot/model/load_profile.h"
#include "solve/robot_setup/check_robot.h"
#include "solve/robot_setup/derive_config.h"
#include "solve/robot_setup/import_robot.h"

namespace retarget {
namespace {

std::vector<std::string> config_files(const RobotSources& sources) {
  std::vector<std::string> files = {sources.config};
  if (!sources.config_of_others.empty()) files.push_back(sources.config_of_others);
  return files;
}

// Reads a configuration, or adds its error. Empty without a file.
std::optional<RetargetingConfig> read_config(const std::string& file, OptionSpelling spelling,
                                             std::vector<RobotFinding>& findings) {
  if (file.empty()) return std::nullopt;
  auto read = load_retargeting_config(file);
  if (read) return std::move(*read);
  findings.push_back({true, located_message(read.error(), spelling)});
  return std::nullopt;
}

// Adds the findings about the robot with its configurations.
void add_findings(const Robot& robot, const RobotSources& sources, bool profile_is_read,
                  OptionSpelling spelling, std::vector<RobotFinding>& findings) {
  const std::vector<std::string> files = config_files(sources);
  for (const std::string& file : files) {
    const auto config = read_config(file, spelling, findings);
    const UnreadFiles unread{!profile_is_read, !config && !file.empty()};
    for (RobotFinding& finding : check_robot(robot, config ? &*config : nullptr, unread)) {
      finding.text = spell_options(finding.text, spelling);
      if (std::ranges::find(findings, finding.text, &RobotFinding::text) != findings.end())
        continue;
      // Findings that only the second configuration causes name its file.
      if (file != files.front()) {
        finding.text = std::filesystem::path(file).filename().string() + ": " + finding.text;
      }
      findings.push_back(std::move(finding));
    }
  }
}

// Derives the configuration that `robots add` would write. Empty without recognised limbs, which
// check_robot() reports.
std::optional<RetargetingConfig> derived_config(const Robot& robot, const std::string& model) {
  const auto limbs = find_limbs(robot, model);
  if (!limbs) return std::nullopt;
  DeriveOptions options;
  options.sole_height = find_shapes(robot, *limbs, mesh_points(robot, model)).ankle_height;
  return derive_config(robot, *limbs, options);
}

// Checks a model that has not been imported yet, reading it as `robots add` does.
Result<std::vector<RobotFinding>> check_bare_model(const RobotSources& sources,
                                                   OptionSpelling spelling) {
  const std::string name = std::filesystem::path(sources.model).stem().string();
  RETARGET_TRY_ASSIGN(auto imported, import_robot(sources.model, name, sources.base));
  std::vector<RobotFinding> findings;
  const auto limbs = find_limbs(*imported.robot, sources.model);
  if (limbs) {
    const auto chains = check_closed_chains(imported, *limbs, sources.model, imported.notes);
    if (!chains) findings.push_back({true, spell_options(full_message(chains.error()), spelling)});
    imported.notes.insert(imported.notes.end(), limbs->notes.begin(), limbs->notes.end());
  }
  for (const std::string& warning : imported.robot->warnings())
    findings.push_back({false, warning});
  for (std::string& note : imported.notes) findings.push_back({false, std::move(note)});
  const auto config = derived_config(*imported.robot, sources.model);
  for (RobotFinding& finding : check_robot(*imported.robot, config ? &*config : nullptr)) {
    finding.text = spell_options(finding.text, spelling);
    findings.push_back(std::move(finding));
  }
  for (RobotFinding& finding : check_shapes(*imported.robot, sources.model)) {
    findings.push_back(std::move(finding));
  }
  std::ranges::stable_sort(findings, std::ranges::greater(), &RobotFinding::fault);
  return findings;
}

// Reports the error of a robot's profile, and findings that do not depend on the profile. Of these,
// the base is needed to check the model.
Result<std::vector<RobotFinding>> check_without_profile(const RobotSources& sources,
                                                        const Error& error,
                                                        OptionSpelling spelling) {
  std::vector<RobotFinding> findings = {{true, located_message(error, spelling)}};
  if (!load_json(sources.profile)) {
    for (const std::string& file : config_files(sources)) {
      static_cast<void>(read_config(file, spelling, findings));
    }
    return findings;
  }
  const bool is_fixed = sources.base == RobotBase::kFixed || states_fixed_base(sources.profile);
  const RobotBase base = is_fixed ? RobotBase::kFixed : sources.base;
  RETARGET_TRY_ASSIGN(const auto bare, load_robot_files(sources.model, {}, base));
  for (const std::string& warning : bare->warnings()) findings.push_back({false, warning});
  add_findings(*bare, sources, false, spelling, findings);
  std::ranges::stable_sort(findings, std::ranges::greater(), &RobotFinding::fault);
  return findings;
}

}  // namespace

Result<std::vector<RobotFinding>> check_robot(const RobotSources& sources,
                                              OptionSpelling spelling) {
  if (sources.profile.empty() && sources.config.empty()) {
    return check_bare_model(sources, spelling);
  }
  const auto robot = load_robot_files(sources.model, sources.profile, sources.base);
  if (!robot && sources.profile.empty()) return failure(robot.error());
  if (!robot) return check_without_profile(sources, robot.error(), spelling);
  std::vector<RobotFinding> findings;
  for (const std::string& warning : (*robot)->warnings()) findings.push_back({false, warning});
  for (const RobotVariant& each : (*robot)->profile().variants) {
    const auto variant = robot_variant(*robot, each.name);
    if (!variant) findings.push_back({true, located_message(variant.error(), spelling)});
  }
  add_findings(**robot, sources, true, spelling, findings);
  for (RobotFinding& finding : check_shapes(**robot, sources.model)) {
    findings.push_back(std::move(finding));
  }
  std::ranges::stable_sort(findings, std::ranges::greater(), &RobotFinding::fault);
  return findings;
}

}  // namespace retarget
