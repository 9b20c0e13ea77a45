// The physics model against inverse dynamics, and the controller against MuJoCo and a standing body.

#include "judge/simulation/whole_body_controller.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>
#include <random>

#include "base/math/gravity.h"
#include "robot/robot_kinematics.h"
#include "robot/shipped_robots.h"
#include "simulation/standing_clip.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

using Data = std::unique_ptr<mjData, void (*)(mjData*)>;

Data data_of(const PhysicsModel& physics) {
  return {mj_makeData(physics.model.get()), mj_deleteData};
}

PhysicsModel physics_of(const Robot& robot) {
  return value_of(make_physics_model(robot, 0.002));
}

void place(const PhysicsModel& physics, const Robot& robot, const MotionState& state,
           mjData* data) {
  physics.set_positions(state.qpos, robot, data->qpos);
  physics.set_rates(state.velocity, data->qvel);
  physics.set_rates(state.acceleration, data->qacc);
}

// Inverse dynamics without contacts and limits.
VectorXd inverse(const PhysicsModel& physics, mjData* data) {
  const int flags = physics.model->opt.disableflags;
  physics.model->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_CONTACT | mjDSBL_LIMIT;
  mj_inverse(physics.model.get(), data);
  physics.model->opt.disableflags = flags;
  return Eigen::Map<const VectorXd>(data->qfrc_inverse, physics.model->nv);
}

TEST(PhysicsModel, HasTheRobotsDynamics) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (const char* name : {"unitree_g1", "pal_talos", "stanford_toddy"}) {
    const auto robot = load_shipped(name);
    const PhysicsModel physics = physics_of(*robot);
    const Data data = data_of(physics);
    const Inertias inertias = make_inertias(*robot);
    InverseDynamics own(robot->tree(), inertias);
    MotionState state(*robot);
    for (int round = 0; round < 5; ++round) {
      state.qpos = random_configuration(*robot, random);
      for (double& v : state.velocity) v = 2.0 * normal(random);
      for (double& a : state.acceleration) a = 10.0 * normal(random);
      own.compute(TreeState(robot->tree(), state.qpos), state.velocity, state.acceleration);
      VectorXd wanted(physics.model->nv);
      physics.set_rates({own.forces().begin(), own.forces().end()}, wanted.data());
      place(physics, *robot, state, data.get());
      const VectorXd is = inverse(physics, data.get());
      EXPECT_LT((is - wanted).cwiseAbs().maxCoeff(), 1e-9 * wanted.cwiseAbs().maxCoeff()) << name;
    }
  }
}

TEST(PhysicsModel, RejectsRobotsThatCannotStand) {
  const auto whole = load_shipped("unitree_g1");
  RobotProfile profile = whole->profile();
  profile.soles.clear();
  Robot bare(ModelPtr(mj_copyModel(nullptr, whole->model())), profile);
  const auto without_soles = make_physics_model(bare, 0.002);
  ASSERT_FALSE(without_soles);
  EXPECT_NE(without_soles.error().message.find("soles"), std::string::npos);
  profile = whole->profile();
  profile.fixed_base = true;
  Robot fixed(ModelPtr(mj_copyModel(nullptr, whole->model())), profile);
  EXPECT_FALSE(make_physics_model(fixed, 0.002));
}

// The planned accelerations, torques and forces satisfy MuJoCo's equation of motion.
TEST(WholeBodyController, PlansMatchMujoco) {
  const auto robot = load_shipped("unitree_g1");
  const PhysicsModel physics = physics_of(*robot);
  const Data data = data_of(physics);
  const RobotClip clip = standing_clip(robot, 10);
  ReferenceTrack track(clip, 17, 0.0);
  WholeBodyController controller(physics, *robot);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 5; ++round) {
    const ReferenceState& reference = track.at(round + 20);
    physics.set_positions(reference.motion.qpos, *robot, data->qpos);
    for (int i = 0; i < physics.model->nv; ++i) data->qvel[i] = 0.2 * normal(random);
    mj_fwdPosition(physics.model.get(), data.get());
    mj_fwdVelocity(physics.model.get(), data.get());
    const ControlStep& step = controller.compute(reference, track.time_step(), data.get());
    ASSERT_TRUE(step.converged);
    ASSERT_GE(step.points.size(), 6U);
    VectorXd given = VectorXd::Zero(physics.model->nv);
    for (std::size_t i = 0; i < step.points.size(); ++i) {
      const PhysicsPoint& point = physics.points[step.points[i]];
      const mjtNum* q = data->xquat + 4L * point.body;
      const Vector3d at = Eigen::Map<const Vector3d>(data->xpos + 3L * point.body) +
                          Eigen::Quaterniond(q[0], q[1], q[2], q[3]) * point.in_body -
                          point.radius * Vector3d::UnitZ();
      const Vector3d& force = step.forces[i];
      EXPECT_LE(force.head<2>().norm(), 0.7 * force.z() + 1e-9);
      const Vector3d none = Vector3d::Zero();
      mj_applyFT(physics.model.get(), data.get(), force.data(), none.data(), at.data(), point.body,
                 given.data());
    }
    for (std::size_t i = 0; i < physics.joints.size(); ++i) {
      EXPECT_LE(std::abs(step.torques[i]), physics.joints[i].limit);
      given[physics.joints[i].dof] += step.torques[i];
    }
    std::ranges::copy(step.acceleration, data->qacc);
    const VectorXd needed = inverse(physics, data.get());
    EXPECT_LT((given - needed).cwiseAbs().maxCoeff(), 1e-9 * needed.cwiseAbs().maxCoeff());
  }
}

// Under the controller, the floor carries the weight of a standing body.
TEST(WholeBodyController, StandingForcesSumToTheWeight) {
  for (const char* name : {"unitree_g1", "engineai_pm01", "stanford_toddy"}) {
    const auto robot = load_shipped(name);
    const PhysicsModel physics = physics_of(*robot);
    const Data data = data_of(physics);
    const RobotClip clip = standing_clip(robot, 60);
    ReferenceTrack track(clip, 17, 0.0);
    WholeBodyController controller(physics, *robot);
    place(physics, *robot, track.at(0).motion, data.get());
    Vector3d planned = Vector3d::Zero();
    VectorXd acceleration;
    for (int k = 0; k < track.step_count(); ++k) {
      mj_fwdPosition(physics.model.get(), data.get());
      mj_fwdVelocity(physics.model.get(), data.get());
      const ControlStep& step = controller.compute(track.at(k), track.time_step(), data.get());
      for (std::size_t i = 0; i < physics.joints.size(); ++i) {
        data->qfrc_applied[physics.joints[i].dof] = step.torques[i];
      }
      planned.setZero();
      acceleration = step.acceleration;
      for (const Vector3d& force : step.forces) planned += force;
      mj_fwdActuation(physics.model.get(), data.get());
      mj_fwdAcceleration(physics.model.get(), data.get());
      mj_fwdConstraint(physics.model.get(), data.get());
      mj_implicit(physics.model.get(), data.get());
    }
    const double weight = physics.mass * kGravity;
    double floor = 0.0;
    for (int c = 0; c < data->ncon; ++c) {
      mjtNum force[6];
      mj_contactForce(physics.model.get(), data.get(), c, force);
      floor += force[0];
    }
    // The planned forces also push the body up: MuJoCo's contacts are soft, and it sinks by 1 mm.
    Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor> com(3, physics.model->nv);
    mj_jacSubtreeCom(physics.model.get(), data.get(), com.data(), 1);
    EXPECT_NEAR(planned.z(), weight + physics.mass * com.row(2).dot(acceleration), 1e-4 * weight)
        << name;
    EXPECT_NEAR(floor, weight, 0.01 * weight) << name;
    EXPECT_NEAR(planned.head<2>().norm(), 0.0, 0.01 * weight) << name;
  }
}

}  // namespace
}  // namespace retarget
