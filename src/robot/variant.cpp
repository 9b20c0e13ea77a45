#include "robot/variant.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/faults.h"
#include "base/suggest.h"
#include "base/try.h"
#include "robot/load_model.h"

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

// what keeps a model from being that of a variant: its root and joints are the robot's without the
// locked ones
Result<void> check_variant_model(const Robot& whole, const Robot& bare,
                                 const RobotVariant& variant) {
  Faults faults;
  const std::string it = "the model of the variant \"" + variant.name + "\"";
  const std::string& root = whole.bodies()[whole.root_body()].name;
  if (bare.bodies()[bare.root_body()].name != root) {
    faults.add(it + " must have its free joint on \"" + root + "\", as the robot has");
  }
  for (const RobotJoint& joint : bare.joints()) {
    if (variant.locked.contains(joint.name)) {
      faults.add(it + " has the joint \"" + joint.name + "\", which the variant locks");
    } else if (!whole.find_joint(joint.name)) {
      faults.add(it + " has the joint \"" + joint.name + "\", which the robot has not" +
                 faults.suggestion(joint.name, whole.joint_names()));
    }
  }
  for (const RobotJoint& joint : whole.joints()) {
    if (bare.find_joint(joint.name) || variant.locked.contains(joint.name)) continue;
    faults.add(it + " lacks the joint \"" + joint.name + "\", which the variant does not lock");
  }
  for (const Sole& sole : whole.profile().soles) {
    const std::string& body = whole.bodies()[sole.body].name;
    if (!bare.find_body(body)) faults.add(it + " lacks the body \"" + body + "\" of a sole");
  }
  if (faults.empty()) return {};
  return faults.failure_in(variant.model, it);
}

// what a profile says of the bodies and joints that another model of the robot has too, whose
// indices are others
RobotProfile profile_for(const Robot& whole, const Robot& bare) {
  RobotProfile profile = whole.profile();
  std::erase_if(profile.joint_order, [&](const auto& name) { return !bare.find_joint(name); });
  std::erase_if(profile.t_pose, [&](const auto& entry) { return !bare.find_joint(entry.first); });
  std::erase_if(profile.coupled_joints, [&](const auto& entry) {
    return !bare.find_joint(entry.first) || !bare.find_joint(entry.second.leader);
  });
  for (LimitSet& set : profile.limit_sets) {
    const LimitSet all = std::exchange(set, bare.model_limits());
    set.name = all.name;
    set.source = all.source;
    for (std::size_t j = 0; j < bare.joints().size(); ++j) {
      const int joint = whole.find_joint(bare.joints()[j].name).value();
      set.lower[j] = all.lower[joint];
      set.upper[j] = all.upper[joint];
    }
  }
  const auto body = [&](int index) { return bare.find_body(whole.bodies()[index].name); };
  for (Sole& sole : profile.soles) sole.body = body(sole.body).value();
  std::erase_if(profile.allowed_self_contact,
                [&](const auto& pair) { return !body(pair.first) || !body(pair.second); });
  for (auto& [a, b] : profile.allowed_self_contact) {
    a = body(a).value();
    b = body(b).value();
  }
  return profile;
}

Result<std::shared_ptr<const Robot>> load_variant(const std::shared_ptr<const Robot>& whole,
                                                  const RobotVariant& variant) {
  TRY_ASSIGN(auto loaded, load_model(variant.model));
  TRY(check_robot_joints(*loaded.model, variant.model));
  auto robot =
      std::make_shared<Robot>(std::move(loaded.model), RobotProfile(), std::move(loaded.warnings));
  TRY(check_variant_model(*whole, *robot, variant));
  robot->set_profile(profile_for(*whole, *robot));
  robot->set_variant(variant);
  robot->set_whole(whole);
  return robot;
}

}  // namespace

Result<std::shared_ptr<const Robot>> make_variant(const std::shared_ptr<const Robot>& robot,
                                                  const RobotVariant& variant) {
  if (!variant.model.empty()) {
    return load_variant(robot->whole() ? robot->whole() : robot, variant);
  }
  ModelPtr model(mj_copyModel(nullptr, robot->model()));
  auto held = std::make_shared<Robot>(std::move(model), robot->profile(), robot->warnings());
  held->set_collision_shapes(robot->collision_shapes());
  held->set_variant(variant);
  return held;
}

Result<std::shared_ptr<const Robot>> robot_variant(const std::shared_ptr<const Robot>& robot,
                                                   const std::string& name) {
  for (const RobotVariant& variant : robot->profile().variants) {
    if (variant.name == name) return make_variant(robot, variant);
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
