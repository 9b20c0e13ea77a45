#include "judge/simulation/physics_model.h"

#include <mujoco/mujoco.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/math/gravity.h"
#include "base/try.h"
#include "retarget/kinematic_tree.h"
#include "retarget/so3.h"
#include "robot/model/model_values.h"
#include "robot/model/mujoco_messages.h"
#include "solve/dynamics/inertias.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kStopDistance = 0.05;  // From the end of a joint range to its hard stop, rad or m.
constexpr double kSmallestRadius = 1e-4;  // Metres; MuJoCo requires a positive radius.

void copy(const Vector3d& from, double* to) {
  for (int k = 0; k < 3; ++k) to[k] = from[k];
}

void copy(const Eigen::Quaterniond& from, double* to) {
  to[0] = from.w();
  copy(Vector3d(from.vec()), to + 1);
}

// Sets the inertia in principal axes, the eigenvectors of the inertia matrix, as MuJoCo requires.
void set_inertia(const LinkInertia& inertia, mjsBody* body) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(inertia.about_com);
  Eigen::Matrix3d turn = axes.eigenvectors();
  if (turn.determinant() < 0.0) turn.col(2) = -turn.col(2);
  body->mass = inertia.mass;
  body->explicitinertial = 1;
  copy(inertia.com, body->ipos);
  copy(Eigen::Quaterniond(turn), body->iquat);
  copy(axes.eigenvalues().cwiseMax(1e-9), body->inertia);
}

// Builds the model link by link. The z axis of a link's body is the axis of its joint.
class Builder {
 public:
  Builder(const Robot& robot, mjSpec* spec)
      : robot_(robot), spec_(spec), inertias_(make_inertias(robot)) {}

  void build(PhysicsModel& physics) {
    add_floor();
    const auto& links = robot_.tree().links();
    bodies_.resize(links.size());
    for (std::size_t i = 0; i < links.size(); ++i) add_link(i, links[i], physics);
    for (const SupportPoint& point : make_support_points(robot_)) add_point(point, physics);
    physics.mass = inertias_.mass;
  }

 private:
  void add_floor() {
    mjsGeom* floor = mjs_addGeom(mjs_findBody(spec_, "world"), nullptr);
    floor->type = mjGEOM_PLANE;
    floor->size[2] = 1.0;
    touch(floor, 1, 0);
  }

  // Sets the contact properties of a geom. MuJoCo tests two geoms for contact if the type of one
  // matches the affinity of the other, so that spheres collide only with the floor.
  static void touch(mjsGeom* geom, int type, int affinity) {
    geom->contype = type;
    geom->conaffinity = affinity;
    geom->condim = 3;
    geom->friction[0] = kFloorFriction;
  }

  void add_link(std::size_t index, const KinematicTree::Link& link, PhysicsModel& physics) {
    mjsBody* parent = index == 0 ? mjs_findBody(spec_, "world") : bodies_[link.parent];
    mjsBody* body = mjs_addBody(parent, nullptr);
    bodies_[index] = body;
    set_inertia(inertias_.links[index], body);
    if (index == 0) {
      mjs_addFreeJoint(body);
      return;
    }
    Pose pose = link.parent_from_link;
    const RobotJoint& joint = robot_.joints()[link.joint];
    const auto held = robot_.variant().locked.find(joint.name);
    if (held != robot_.variant().locked.end()) {
      pose = pose * moved_by(link, held->second - link.reference);
    } else {
      add_joint(link, body, physics);
    }
    copy(pose.translation, body->pos);
    copy(pose.rotation, body->quat);
  }

  static Pose moved_by(const KinematicTree::Link& link, double amount) {
    if (link.slides) return {Eigen::Quaterniond::Identity(), amount * Vector3d::UnitZ()};
    return {exp_so3(amount * Vector3d::UnitZ()), Vector3d::Zero()};
  }

  void add_joint(const KinematicTree::Link& link, mjsBody* body, PhysicsModel& physics) {
    mjsJoint* joint = mjs_addJoint(body, nullptr);
    joint->type = link.slides ? mjJNT_SLIDE : mjJNT_HINGE;
    copy(Vector3d::UnitZ(), joint->axis);
    joint->ref = link.reference;
    joint->armature = robot_.rotor_inertia(link.joint);
    const double lower = robot_.model_limits().lower[link.joint];
    const double upper = robot_.model_limits().upper[link.joint];
    if (std::isfinite(lower) && std::isfinite(upper) && lower <= upper) {
      joint->limited = mjLIMITED_TRUE;
      joint->range[0] = lower - kStopDistance;
      joint->range[1] = upper + kStopDistance;
    } else {
      joint->limited = mjLIMITED_FALSE;
    }
    const int dof = 6 + static_cast<int>(physics.joints.size());
    physics.joints.push_back({link.joint, dof, robot_.torque_limit(link.joint)});
  }

  void add_point(const SupportPoint& point, PhysicsModel& physics) {
    const double radius = std::max(point.radius, kSmallestRadius);
    mjsGeom* geom = mjs_addGeom(bodies_[point.link], nullptr);
    geom->type = mjGEOM_SPHERE;
    geom->size[0] = radius;
    copy(point.in_link, geom->pos);
    touch(geom, 0, 1);
    // The world is body 0; links follow in their order.
    physics.points.push_back({point.link + 1, point.in_link, radius, point.of_sole});
  }

  const Robot& robot_;
  mjSpec* spec_;
  Inertias inertias_;
  std::vector<mjsBody*> bodies_;  // One per link.
};

Result<void> check_robot(const Robot& robot) {
  if (robot.fixed_base()) {
    return config_failure(robot.name(), "a robot with a fixed base does not stand on a floor",
                          "simulate a robot with legs");
  }
  if (robot.profile().soles.empty()) {
    return config_failure(robot.name(), "the robot has no soles to stand on",
                          "add soles to robot.json (docs/own_robot.md)");
  }
  if (!(make_inertias(robot).mass > 0.0)) {
    return config_failure(robot.name(), "the robot's model has no masses",
                          "use a model with inertias");
  }
  return {};
}

}  // namespace

void PhysicsModel::set_positions(const std::vector<double>& robot_qpos, const Robot& robot,
                                 double* qpos) const {
  std::copy_n(robot_qpos.begin(), 7, qpos);
  for (const PhysicsJoint& each : joints) {
    qpos[each.dof + 1] = robot_qpos[robot.joints()[each.joint].qpos_address];
  }
}

void PhysicsModel::set_rates(const std::vector<double>& of_tree, double* rates) const {
  std::copy_n(of_tree.begin(), 6, rates);
  // Joint i moves link i + 1.
  for (const PhysicsJoint& each : joints) {
    rates[each.dof] = of_tree[KinematicTree::dof_of(each.joint + 1)];
  }
}

Result<PhysicsModel> make_physics_model(const Robot& robot, double time_step) {
  RETARGET_TRY(check_robot(robot));
  const std::scoped_lock lock(mujoco_mutex());
  const MessageGuard guard;
  const MujocoSpec spec(mj_makeSpec());
  spec->compiler.degree = 0;
  spec->compiler.autolimits = 0;
  spec->compiler.boundmass = 1e-6;
  spec->compiler.boundinertia = 1e-9;
  spec->compiler.balanceinertia = 1;
  spec->option.timestep = time_step;
  spec->option.integrator = mjINT_IMPLICITFAST;
  spec->option.cone = mjCONE_ELLIPTIC;
  spec->option.impratio = 10.0;  // Reduces the creep of feet that should stick.
  spec->option.gravity[2] = -kGravity;
  PhysicsModel physics;
  Builder(robot, spec.get()).build(physics);
  physics.model.reset(mj_compile(spec.get(), nullptr));
  if (!physics.model) return model_failure(robot.name(), mjs_getError(spec.get()));
  return physics;
}

}  // namespace retarget
