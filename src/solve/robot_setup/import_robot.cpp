#include "solve/robot_setup/import_robot.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "retarget/kinematic_tree.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Profiles and configurations refer to these names in JSON, which is UTF-8.
Result<void> check_names(const mjModel& model, const std::string& path) {
  const std::string_view names(model.names, static_cast<std::size_t>(model.nnames));
  for (std::size_t at = 0; at < names.size();) {
    const std::string_view name = names.substr(at, names.find('\0', at) - at);
    if (valid_utf8(name) != name) {
      return config_failure(path, "the name \"" + valid_utf8(name) + "\" is not UTF-8",
                            "save the model as UTF-8, or use ASCII names");
    }
    at += name.size() + 1;
  }
  return {};
}

std::string quoted_names(std::vector<std::string> names) {
  for (std::string& name : names) name = "\"" + name + "\"";
  return list_names(names, 6);
}

}  // namespace

Result<ImportedRobot> import_robot(const std::string& path, const std::string& name,
                                   RobotBase base) {
  ModelChanges changes;
  changes.float_base = true;
  changes.name_all = true;
  RETARGET_TRY_ASSIGN(auto loaded, load_model(path, changes));
  RETARGET_TRY(check_robot_joints(*loaded.model, path));
  RETARGET_TRY(check_names(*loaded.model, path));
  ImportedRobot imported;
  const bool fixed = base == RobotBase::kFixed;
  if (!loaded.sliding.empty()) {
    imported.notes.push_back("the root moved by " + quoted_names(loaded.sliding) + ": " +
                             (fixed ? "they are locked" : "a free joint replaces them"));
  } else if (!loaded.floated_body.empty() && !fixed) {
    imported.notes.push_back("the model had no free joint: \"" + loaded.floated_body +
                             "\" was given one");
  }
  if (!loaded.held.empty()) {
    imported.notes.push_back("ball joints that move nothing else are locked: " +
                             quoted_names(loaded.held));
  }
  imported.tied = std::move(loaded.tied);
  imported.excluded = std::move(loaded.excluded);
  RobotProfile profile;
  profile.name = name;
  profile.fixed_base = fixed;
  profile.coupled_joints = std::move(loaded.couplings);
  imported.robot = std::make_shared<Robot>(std::move(loaded.model), std::move(profile),
                                           std::move(loaded.warnings));
  return imported;
}

Result<void> check_closed_chains(const ImportedRobot& imported, const RobotAnatomy& limbs,
                                 const std::string& path, std::vector<std::string>& notes) {
  const Robot& robot = *imported.robot;
  const KinematicTree& tree = robot.tree();
  std::vector<int> ends;
  for (const auto* pair : {&limbs.legs, &limbs.arms}) {
    for (const Limb& limb : *pair) {
      if (limb.joints.empty()) continue;
      ends.push_back(tree.link_of_joint(limb.joints.back()));
    }
  }
  // Returns true if the body moves with a limb or carries one.
  const auto is_main = [&](const std::string& name) {
    const auto body = robot.find_body(name);
    if (!body) return false;
    const int link = tree.attachment(*body).link;
    return link <= 0 || std::ranges::any_of(ends, [&](int end) { return tree.carries(link, end); });
  };
  for (const auto& [first, second] : imported.tied) {
    if (is_main(first) && is_main(second)) {
      return config_failure(
          path,
          "the model has a closed chain, which a kinematic tree cannot represent: an equality ties "
          "\"" +
              first + "\" to \"" + second + "\"",
          "remove the equality if the rest of the tree moves without it");
    }
    notes.push_back("an equality ties \"" + first + "\" to \"" + second +
                    "\": the equality is dropped, and \"" + (is_main(first) ? second : first) +
                    "\" does not follow");
  }
  return {};
}

}  // namespace retarget
