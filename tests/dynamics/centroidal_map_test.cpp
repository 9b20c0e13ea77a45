// Jacobian of the centre of mass and angular momentum matrix against MuJoCo's.

#include "solve/dynamics/centroidal_map.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <random>
#include <vector>

#include "robot/robot_kinematics.h"
#include "robot/shipped_robots.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using RowMajor3Xd = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

TEST(CentroidalMap, RowsMatchMujoco) {
  for (const char* name : {"unitree_g1", "pal_talos", "booster_t1_29dof"}) {
    const auto robot = load_shipped(name);
    const mjModel* model = robot->model();
    const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(model), mj_deleteData);
    const Inertias inertias = make_inertias(*robot);
    CentroidalMap map(robot->tree(), inertias);
    std::mt19937 random(4);
    for (int round = 0; round < 10; ++round) {
      const std::vector<double> qpos = random_configuration(*robot, random);
      std::ranges::copy(qpos, data->qpos);
      mju_normalize4(data->qpos + 3);
      mj_kinematics(model, data.get());
      mj_comPos(model, data.get());
      RowMajor3Xd com(3, model->nv), spin(3, model->nv);
      mj_jacSubtreeCom(model, data.get(), com.data(), robot->root_body());
      mj_angmomMat(model, data.get(), spin.data(), robot->root_body());
      const TreeState state(robot->tree(), qpos);
      map.update(state);
      const Eigen::Map<const Eigen::Vector3d> centre(data->subtree_com + 3L * robot->root_body());
      EXPECT_LT((map.com() - centre).norm(), 1e-12) << name;
      EXPECT_LT((map.rows().topRows<3>() - com).cwiseAbs().maxCoeff(), 1e-12) << name;
      EXPECT_LT((map.rows().bottomRows<3>() - spin).cwiseAbs().maxCoeff(), 1e-11) << name;
    }
  }
}

}  // namespace
}  // namespace retarget
