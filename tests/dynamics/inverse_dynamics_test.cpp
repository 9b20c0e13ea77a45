// Recursive Newton-Euler against MuJoCo's inverse dynamics, and its sums against closed forms.

#include "solve/dynamics/inverse_dynamics.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <random>

#include "dynamics/inverse_model.h"
#include "robot/robot_kinematics.h"
#include "robot/shipped_robots.h"
#include "solve/dynamics/motion_spline.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

std::vector<std::shared_ptr<const Robot>> robots() {
  return {robot_from_text(kOddRobot), load_shipped("unitree_g1"), load_shipped("pal_talos"),
          load_shipped("stanford_toddy")};
}

// MuJoCo's inverse dynamics with only weight and inertia.
class Reference {
 public:
  explicit Reference(const Robot& robot)
      : model_(inverse_model(robot)), data_(mj_makeData(model_.get()), mj_deleteData) {}

  std::vector<double> forces(const MotionState& state) {
    std::ranges::copy(state.qpos, data_->qpos);
    std::ranges::copy(state.velocity, data_->qvel);
    std::ranges::copy(state.acceleration, data_->qacc);
    mj_inverse(model_.get(), data_.get());
    mj_comVel(model_.get(), data_.get());
    mj_subtreeVel(model_.get(), data_.get());
    return {data_->qfrc_inverse, data_->qfrc_inverse + model_->nv};
  }

  // Generalised forces of a force at a point of a body, in the state of the last forces().
  std::vector<double> of_force(int body, const Vector3d& point, const Vector3d& force) {
    std::vector<double> forces(static_cast<std::size_t>(model_->nv), 0.0);
    const Vector3d torque = Vector3d::Zero();
    mj_applyFT(model_.get(), data_.get(), force.data(), torque.data(), point.data(), body,
               forces.data());
    return forces;
  }

  [[nodiscard]] Vector3d com(int root) const {
    return Eigen::Map<const Vector3d>(data_->subtree_com + 3 * root);
  }
  [[nodiscard]] Vector3d angular_momentum(int root) const {
    return Eigen::Map<const Vector3d>(data_->subtree_angmom + 3 * root);
  }

 private:
  ModelPointer model_;
  std::unique_ptr<mjData, void (*)(mjData*)> data_;
};

void randomise(const Robot& robot, std::mt19937& random, MotionState& state) {
  std::normal_distribution<double> normal;
  state.qpos = random_configuration(robot, random);
  const double norm = Eigen::Map<const Eigen::Vector4d>(state.qpos.data() + 3).norm();
  for (int k = 3; k < 7; ++k) state.qpos[k] /= norm;
  for (double& v : state.velocity) v = 3.0 * normal(random);
  for (double& a : state.acceleration) a = 20.0 * normal(random);
}

TEST(InverseDynamics, ForcesMatchMujoco) {
  for (const auto& robot : robots()) {
    const Inertias inertias = make_inertias(*robot);
    InverseDynamics own(robot->tree(), inertias);
    Reference reference(*robot);
    TreeState tree(robot->tree());
    MotionState state(*robot);
    std::mt19937 random(11);
    double worst = 0.0;
    for (int round = 0; round < 50; ++round) {
      randomise(*robot, random, state);
      tree.update(state.qpos);
      own.compute(tree, state.velocity, state.acceleration);
      const std::vector<double> theirs = reference.forces(state);
      double scale = 1.0;
      for (const double force : theirs) scale = std::max(scale, std::abs(force));
      for (std::size_t dof = 0; dof < theirs.size(); ++dof) {
        worst = std::max(worst, std::abs(own.forces()[dof] - theirs[dof]) / scale);
      }
      EXPECT_LT((own.com() - reference.com(robot->root_body())).norm(), 1e-12);
      EXPECT_LT((own.angular_momentum() - reference.angular_momentum(robot->root_body())).norm(),
                1e-10 * scale);
    }
    EXPECT_LT(worst, 1e-12) << robot->name();
  }
}

TEST(InverseDynamics, LoadsMatchMujoco) {
  const auto robot = load_shipped("unitree_g1");
  const Inertias inertias = make_inertias(*robot);
  InverseDynamics own(robot->tree(), inertias);
  Reference reference(*robot);
  TreeState tree(robot->tree());
  MotionState state(*robot);
  std::mt19937 random(12);
  std::normal_distribution<double> normal;
  const int links = static_cast<int>(robot->tree().links().size());
  for (int round = 0; round < 20; ++round) {
    randomise(*robot, random, state);
    tree.update(state.qpos);
    const auto vector = [&] { return Vector3d(normal(random), normal(random), normal(random)); };
    const std::vector<LinkLoad> loads = {{round % links, vector(), 50.0 * vector()},
                                         {(7 * round + 3) % links, vector(), 50.0 * vector()}};
    own.compute(tree, state.velocity, state.acceleration);
    const Vector3d acceleration = own.com_acceleration();
    const Wrench alone = own.needed();
    own.compute(tree, state.velocity, state.acceleration, loads);
    std::vector<double> expected = reference.forces(state);
    double scale = 1.0;
    Wrench carried;
    for (const LinkLoad& load : loads) {
      const int body = robot->tree().links()[static_cast<std::size_t>(load.link)].body;
      const auto added = reference.of_force(body, load.position, load.force);
      for (std::size_t dof = 0; dof < added.size(); ++dof) expected[dof] += added[dof];
      carried.force += load.force;
      carried.torque += (load.position - own.com()).cross(load.force);
    }
    for (const double force : expected) scale = std::max(scale, std::abs(force));
    for (std::size_t dof = 0; dof < expected.size(); ++dof) {
      EXPECT_NEAR(own.forces()[dof], expected[dof], 1e-12 * scale);
    }
    EXPECT_LT((own.needed().force - alone.force - carried.force).norm(), 1e-12 * scale);
    EXPECT_LT((own.needed().torque - alone.torque - carried.torque).norm(), 1e-12 * scale);
    EXPECT_LT((own.com_acceleration() - acceleration).norm(), 1e-12 * scale);
  }
}

TEST(InverseDynamics, AStandingBodyNeedsOnlyItsWeight) {
  const auto robot = load_shipped("unitree_g1");
  const Inertias inertias = make_inertias(*robot);
  InverseDynamics own(robot->tree(), inertias);
  const MotionState state(*robot);
  own.compute(TreeState(robot->tree(), state.qpos), state.velocity, state.acceleration);
  EXPECT_LT((own.needed().force - Vector3d(0, 0, inertias.mass * kGravity)).norm(), 1e-10);
  EXPECT_LT(own.needed().torque.norm(), 1e-10);
  EXPECT_LT(own.com_acceleration().norm(), 1e-12);
}

TEST(InverseDynamics, AFreelyFallingBodyNeedsNoForce) {
  const auto robot = load_shipped("unitree_g1");
  const Inertias inertias = make_inertias(*robot);
  InverseDynamics own(robot->tree(), inertias);
  MotionState state(*robot);
  state.acceleration[2] = -kGravity;
  own.compute(TreeState(robot->tree(), state.qpos), state.velocity, state.acceleration);
  for (const double force : own.forces()) EXPECT_NEAR(force, 0.0, 1e-10);
  EXPECT_LT(own.needed().force.norm() + own.needed().torque.norm(), 1e-10);
}

}  // namespace
}  // namespace retarget
