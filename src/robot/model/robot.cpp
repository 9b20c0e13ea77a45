#include "retarget/robot.h"

#include <mujoco/mujoco.h>
#include <algorithm>
#include <limits>

#include "retarget/kinematic_tree.h"
#include "robot/model/model_values.h"
#include "robot/model/variant.h"

namespace retarget {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <typename T>
std::vector<std::string> names_of(const std::vector<T>& items) {
  std::vector<std::string> names;
  names.reserve(items.size());
  for (const T& item : items) names.push_back(item.name);
  return names;
}

template <typename T>
std::optional<int> index_of(const std::vector<T>& items, std::string_view name) {
  if (name.empty()) return std::nullopt;
  const auto found = std::ranges::find(items, name, &T::name);
  if (found == items.end()) return std::nullopt;
  return static_cast<int>(found - items.begin());
}

}  // namespace

void ModelDeleter::operator()(mjModel_* model) const {
  mj_deleteModel(model);
}

Robot::Robot(ModelPtr model, RobotProfile profile, std::vector<std::string> warnings)
    : model_(std::move(model)), warnings_(std::move(warnings)) {
  read_bodies();
  read_joints();
  tree_ = std::make_shared<KinematicTree>(*this);
  read_collision_shapes();
  set_profile(std::move(profile));
}

void Robot::read_bodies() {
  for (int b = 0; b < model_->nbody; ++b) {
    bodies_.push_back({name_in_model(*model_, mjOBJ_BODY, b), model_->body_parentid[b],
                       pose_at(model_->body_pos, model_->body_quat, b)});
  }
}

void Robot::read_joints() {
  model_limits_.name = "model";
  model_limits_.source = "joint ranges of the model";
  for (int j = 0; j < model_->njnt; ++j) {
    if (model_->jnt_type[j] == mjJNT_FREE) {
      root_body_ = model_->jnt_bodyid[j];
      continue;
    }
    RobotJoint joint;
    joint.name = name_in_model(*model_, mjOBJ_JOINT, j);
    joint.type =
        model_->jnt_type[j] == mjJNT_SLIDE ? RobotJoint::Type::kSlide : RobotJoint::Type::kHinge;
    joint.body = model_->jnt_bodyid[j];
    joint.axis = vector_at(model_->jnt_axis, j);
    joint.anchor = vector_at(model_->jnt_pos, j);
    joint.qpos_address = model_->jnt_qposadr[j];
    joint.dof_address = model_->jnt_dofadr[j];
    joint.reference = model_->qpos0[joint.qpos_address];
    joints_.push_back(joint);
    const bool limited = model_->jnt_limited[j] != 0;
    model_limits_.lower.push_back(limited ? model_->jnt_range[2 * j] : -kInfinity);
    model_limits_.upper.push_back(limited ? model_->jnt_range[2 * j + 1] : kInfinity);
  }
}

void Robot::read_collision_shapes() {
  for (int g = 0; g < model_->ngeom; ++g) {
    const bool touches = model_->geom_contype[g] != 0 || model_->geom_conaffinity[g] != 0;
    const bool of_robot = model_->body_rootid[model_->geom_bodyid[g]] == root_body_;
    if (!touches || !of_robot) continue;
    CollisionShape shape;
    shape.body = model_->geom_bodyid[g];
    shape.geom = g;
    shape.body_from_shape = pose_at(model_->geom_pos, model_->geom_quat, g);
    const Eigen::Vector3d size = vector_at(model_->geom_size, g);
    switch (model_->geom_type[g]) {
      case mjGEOM_SPHERE:
        shape.type = CollisionShape::Type::kSphere;
        shape.radius = size[0];
        break;
      case mjGEOM_CAPSULE:
        shape.type = CollisionShape::Type::kCapsule;
        shape.radius = size[0];
        shape.half_length = size[1];
        break;
      case mjGEOM_BOX:
        shape.type = CollisionShape::Type::kBox;
        shape.half_size = size;
        break;
      default:
        continue;
    }
    collision_shapes_.push_back(shape);
  }
}

void Robot::set_profile(RobotProfile profile) {
  profile_ = std::move(profile);
  output_joints_.clear();
  for (const std::string& name : profile_.joint_order) {
    if (const auto joint = find_joint(name)) output_joints_.push_back(*joint);
  }
  if (profile_.joint_order.empty()) {
    for (std::size_t j = 0; j < joints_.size(); ++j) output_joints_.push_back(static_cast<int>(j));
  }
}

void Robot::set_variant(const RobotVariant& variant) {
  variant_ = variant;
  if (profile_.joint_order.empty()) profile_.joint_order = joint_names();
  std::erase_if(profile_.joint_order,
                [&](const std::string& joint) { return variant.locked.contains(joint); });
  std::erase_if(output_joints_, [&](int j) { return variant.locked.contains(joints_[j].name); });
  for (LimitSet& limits : profile_.limit_sets) hold_locked_joints(*this, limits);
  hold_locked_joints(*this, model_limits_);
}

int Robot::configuration_size() const {
  return static_cast<int>(model_->nq);
}

std::vector<double> Robot::zero_configuration() const {
  std::vector<double> qpos(model_->qpos0, model_->qpos0 + model_->nq);
  for (const auto& [name, position] : variant_.locked) {
    if (const auto joint = find_joint(name)) qpos[joints_[*joint].qpos_address] = position;
  }
  return qpos;
}

int Robot::moved_body(int body) const {
  for (int b = body; b < static_cast<int>(bodies_.size()); ++b) {
    const bool below = b == body || bodies_[b].parent == body;
    if (!below) continue;
    body = b;
    if (std::ranges::count(profile_.joint_frames, bodies_[b].name) == 0) break;
  }
  return body;
}

std::string Robot::limits_for(const std::string& method) const {
  const auto found = profile_.method_limits.find(method);
  if (found != profile_.method_limits.end()) return found->second;
  return profile_.default_limits.empty() ? model_limits_.name : profile_.default_limits;
}

double Robot::speed_limit(int joint) const {
  const RobotJoint& of = joints_[joint];
  const auto found = profile_.speed_limits.find(of.name);
  if (found != profile_.speed_limits.end()) return found->second;
  return of.type == RobotJoint::Type::kHinge ? profile_.default_speed_limit
                                             : kDefaultSlideSpeedLimit;
}

double Robot::torque_limit(int joint) const {
  const auto found = profile_.torque_limits.find(joints_[joint].name);
  if (found != profile_.torque_limits.end()) return found->second;
  // The free joint is the model's first joint.
  const int of_model = joint + 1;
  if (model_->jnt_actfrclimited[of_model] == 0) return kInfinity;
  const mjtNum* range = model_->jnt_actfrcrange + 2L * of_model;
  return std::max(std::abs(range[0]), std::abs(range[1]));
}

double Robot::rotor_inertia(int joint) const {
  const auto found = profile_.rotor_inertias.find(joints_[joint].name);
  if (found != profile_.rotor_inertias.end()) return found->second;
  return model_->dof_armature[joints_[joint].dof_address];
}

std::optional<int> Robot::find_body(std::string_view name) const {
  return index_of(bodies_, name);
}

std::optional<int> Robot::find_joint(std::string_view name) const {
  return index_of(joints_, name);
}

std::vector<std::string> Robot::body_names() const {
  return names_of(bodies_);
}

std::vector<std::string> Robot::joint_names() const {
  return names_of(joints_);
}

}  // namespace retarget
