#include "retarget/robot.h"

#include <mujoco/mujoco.h>

#include <limits>
#include <string>
#include <vector>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/text.h"
#include "robot/model/json_ranges.h"
#include "robot/model/load_model.h"
#include "robot/model/variant.h"

namespace retarget {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// Copies joint ranges from another model of the robot, matched by joint name. That model need not
// be a complete robot.
Result<LimitSet> limits_from_model(const Robot& robot, const std::string& path) {
  TRY_ASSIGN(const auto other, load_model(path));
  const mjModel& model = *other.model;
  LimitSet set = robot.model_limits();
  std::vector<std::string> other_names;
  bool common = false;
  for (int j = 0; j < model.njnt; ++j) {
    const char* name = mj_id2name(&model, mjOBJ_JOINT, j);
    if (name == nullptr) continue;
    other_names.emplace_back(name);
    const auto joint = robot.find_joint(name);
    if (!joint) continue;
    common = true;
    const bool limited = model.jnt_limited[j] != 0;
    set.lower[*joint] = limited ? model.jnt_range[2 * j] : -kNoLimit;
    set.upper[*joint] = limited ? model.jnt_range[2 * j + 1] : kNoLimit;
  }
  if (!common) {
    return config_failure(path, "the model has none of the joints in " + robot.name(),
                          "its joints are " + list_names(other_names));
  }
  return set;
}

Result<LimitSet> limits_from_json(const Robot& robot, const std::string& path) {
  TRY_ASSIGN(const auto json, load_json(path));
  Faults faults;
  LimitSet set = ranges_from_json(json, robot, "the joint limits", faults);
  if (!faults.empty()) return faults.failure_in(path, "the joint limits");
  return set;
}

}  // namespace

Result<LimitSet> load_limits(const Robot& robot, const std::string& name_or_file) {
  std::vector<std::string> names = {robot.model_limits().name};
  if (name_or_file == robot.model_limits().name) return robot.model_limits();
  for (const LimitSet& set : robot.profile().limit_sets) {
    if (set.name == name_or_file) return set;
    names.push_back(set.name);
  }
  const bool is_xml = name_or_file.ends_with(".xml");
  if (!is_xml && !name_or_file.ends_with(".json")) {
    return config_failure(
        "",
        "the robot " + robot.name() + " has no limit set \"" + name_or_file + "\"" +
            did_you_mean(name_or_file, names),
        "its sets are " + list_names(names) + "; a file must end in .json or .xml");
  }
  TRY_ASSIGN(auto set, is_xml ? limits_from_model(robot, name_or_file)
                              : limits_from_json(robot, name_or_file));
  set.name = name_or_file;
  set.source = name_or_file;
  hold_locked_joints(robot, set);
  return set;
}

}  // namespace retarget
