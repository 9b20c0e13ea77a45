#include "robot/model/variant.h"

#include <mujoco/mujoco.h>
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/faults.h"
#include "base/try.h"
#include "retarget/text.h"
#include "robot/model/load_model.h"
#include "robot/model/model_values.h"

namespace retarget {
namespace {

Failure unknown_variant(const Robot& robot, const std::string& whole, const std::string& name) {
  std::vector<std::string> known = {whole};
  for (const RobotVariant& variant : robot.profile().variants) known.push_back(variant.name);
  const std::string message = "the robot " + robot.name() + " has no variant \"" + name + "\"";
  if (known.size() == 1) {
    return config_failure("", message, "it has no variants, only all " + whole + " joints");
  }
  return config_failure("", message + did_you_mean(name, known),
                        "its variants are " + list_names(known) + "; the first one has all joints");
}

// Checks that a model fits a variant: its root and joints must be the robot's without the locked
// ones.
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
      faults.add(it + " has the joint \"" + joint.name + "\", which the robot does not have" +
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

// Restricts a profile to the bodies and joints that the variant's model has, with their new
// indices.
RobotProfile profile_for(const Robot& whole, const Robot& bare) {
  RobotProfile profile = whole.profile();
  std::erase_if(profile.joint_order, [&](const auto& name) { return !bare.find_joint(name); });
  std::erase_if(profile.t_pose, [&](const auto& entry) { return !bare.find_joint(entry.first); });
  std::erase_if(profile.coupled_joints, [&](const auto& entry) {
    return !bare.find_joint(entry.first) || !bare.find_joint(entry.second.leader);
  });
  std::erase_if(profile.joint_frames, [&](const auto& name) { return !bare.find_body(name); });
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

// Moves the anchors used for limb measurement. An anchor may move only along the joint's axis,
// which does not change the motion.
Result<void> move_anchors(const RobotVariant& variant, mjModel& model) {
  constexpr double kOnAxis = 1e-6;
  Faults faults;
  for (const auto& [name, anchor] : variant.anchors) {
    const std::string what =
        "the anchor of \"" + name + "\" in the variant \"" + variant.name + "\"";
    const int joint = mj_name2id(&model, mjOBJ_JOINT, name.c_str());
    if (joint < 0) {
      faults.add(what + ": its model has no such joint");
      continue;
    }
    mjtNum* own = model.jnt_pos + 3 * static_cast<std::ptrdiff_t>(joint);
    const Eigen::Vector3d off = anchor - vector_at(model.jnt_pos, joint);
    if (off.cross(vector_at(model.jnt_axis, joint)).norm() > kOnAxis) {
      faults.add(what + " does not lie on the joint's axis");
      continue;
    }
    std::copy_n(anchor.data(), 3, own);
  }
  if (faults.empty()) return {};
  return faults.failure_in(variant.model, "the model of the variant \"" + variant.name + "\"");
}

Result<std::shared_ptr<const Robot>> load_variant(const std::shared_ptr<const Robot>& whole,
                                                  const RobotVariant& variant) {
  TRY_ASSIGN(auto loaded, load_model(variant.model));
  TRY(check_robot_joints(*loaded.model, variant.model));
  TRY(move_anchors(variant, *loaded.model));
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
