#include "robot/variant.h"

#include <mujoco/mujoco.h>

#include <utility>
#include <vector>

#include "base/suggest.h"

namespace retarget {
namespace {

Failure unknown_variant(const Robot& robot, const std::string& whole, const std::string& name) {
  std::vector<std::string> known = {whole};
  for (const RobotVariant& variant : robot.profile().variants) known.push_back(variant.name);
  const std::string message = "the robot " + robot.name() + " has no variant \"" + name + "\"";
  if (known.size() == 1) {
    return config_failure("", message, "its " + whole + " joints are all there are");
  }
  return config_failure("", message + did_you_mean(name, known),
                        "its variants are " + list_names(known) + "; the first is the whole robot");
}

}  // namespace

Result<std::shared_ptr<const Robot>> robot_variant(const std::shared_ptr<const Robot>& robot,
                                                   const std::string& name) {
  for (const RobotVariant& variant : robot->profile().variants) {
    if (variant.name != name) continue;
    ModelPtr model(mj_copyModel(nullptr, robot->model()));
    auto held = std::make_shared<Robot>(std::move(model), robot->profile(), robot->warnings());
    held->set_collision_shapes(robot->collision_shapes());
    held->set_variant(variant);
    return held;
  }
  const std::string whole = std::to_string(robot->output_joints().size());
  if (name == whole) return robot;
  return unknown_variant(*robot, whole, name);
}

void hold_locked_joints(const Robot& robot, LimitSet& limits) {
  for (const auto& [name, position] : robot.variant().locked) {
    const auto joint = robot.find_joint(name);
    if (!joint) continue;
    limits.lower[*joint] = position;
    limits.upper[*joint] = position;
  }
}

}  // namespace retarget
