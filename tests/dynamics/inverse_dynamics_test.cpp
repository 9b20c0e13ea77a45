// Recursive Newton-Euler against MuJoCo's inverse dynamics, and its sums against closed forms.

#include "solve/dynamics/inverse_dynamics.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <random>

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
      : model_(mj_copyModel(nullptr, robot.model()), mj_deleteModel),
        data_(mj_makeData(model_.get()), mj_deleteData) {
    model_->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_CONTACT | mjDSBL_LIMIT;
    mju_zero(model_->dof_damping, model_->nv);
    mju_zero(model_->dof_frictionloss, model_->nv);
    mju_zero(model_->jnt_stiffness, model_->njnt);
    model_->opt.gravity[2] = -kGravity;
    for (int j = 0; j < static_cast<int>(robot.joints().size()); ++j) {
      model_->dof_armature[robot.joints()[j].dof_address] = robot.rotor_inertia(j);
    }
  }

  std::vector<double> forces(const MotionState& state) {
    std::ranges::copy(state.qpos, data_->qpos);
    std::ranges::copy(state.velocity, data_->qvel);
    std::ranges::copy(state.acceleration, data_->qacc);
    mj_inverse(model_.get(), data_.get());
    mj_comVel(model_.get(), data_.get());
    mj_subtreeVel(model_.get(), data_.get());
    return {data_->qfrc_inverse, data_->qfrc_inverse + model_->nv};
  }

  [[nodiscard]] Vector3d com(int root) const {
    return Eigen::Map<const Vector3d>(data_->subtree_com + 3 * root);
  }
  [[nodiscard]] Vector3d angular_momentum(int root) const {
    return Eigen::Map<const Vector3d>(data_->subtree_angmom + 3 * root);
  }

 private:
  std::unique_ptr<mjModel, void (*)(mjModel*)> model_;
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
