// The kinematic tree and its composite assembly, against MuJoCo and finite differences.

#include "retarget/kinematic_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <random>
#include <set>

#include "retarget/so3.h"
#include "robot/model/composite.h"
#include "robot_kinematics.h"
#include "shipped_robots.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Matrix6Xd = Eigen::Matrix<double, 6, Eigen::Dynamic>;
using RowMajor3Xd = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

std::vector<std::shared_ptr<const Robot>> robots() {
  return {robot_from_text(kTwoArms), robot_from_text(kOddRobot), load_shipped("unitree_g1"),
          load_shipped("pal_talos"), load_shipped("unitree_h1_2")};
}

// MuJoCo's kinematics of a configuration.
class Reference {
 public:
  Reference(const Robot& robot, const std::vector<double>& qpos)
      : model_(robot.model()), data_(mj_makeData(model_), mj_deleteData) {
    std::ranges::copy(qpos, data_->qpos);
    mj_kinematics(model_, data_.get());
    mj_comPos(model_, data_.get());
  }

  // Velocity of a point of a body and its angular velocity, for MuJoCo's degrees of freedom.
  [[nodiscard]] Matrix6Xd jacobian(int body, const Vector3d& point) const {
    RowMajor3Xd linear(3, model_->nv), angular(3, model_->nv);
    mj_jac(model_, data_.get(), linear.data(), angular.data(), point.data(), body);
    Matrix6Xd jacobian(6, model_->nv);
    jacobian << linear, angular;
    return jacobian;
  }

  [[nodiscard]] Vector3d anchor(int joint) const { return of_joint(data_->xanchor, joint); }
  [[nodiscard]] Vector3d axis(int joint) const { return of_joint(data_->xaxis, joint); }

 private:
  // The first joint of the model is the free one.
  static Vector3d of_joint(const double* values, int joint) {
    return Eigen::Map<const Vector3d>(values + 3 * (joint + 1));
  }

  const mjModel* model_;
  std::unique_ptr<mjData, void (*)(mjData*)> data_;
};

int mujoco_dof(const Robot& robot, int dof) {
  if (dof < KinematicTree::kBaseDofs) return dof;
  const int link = dof - KinematicTree::dof_of(0);
  return robot.joints()[robot.tree().links()[link].joint].dof_address;
}

// Velocity of a point of a body and its angular velocity, for the tree's degrees of freedom.
Matrix6Xd own_jacobian(const TreeState& state, int body, const Vector3d& point) {
  Matrix6Xd jacobian = Matrix6Xd::Zero(6, state.tree->dof_count());
  const int link = state.tree->attachment(body).link;
  if (link == KinematicTree::kWorld) return jacobian;
  for (const int dof : state.tree->carriers(KinematicTree::dof_of(link))) {
    jacobian.col(dof) << state.velocity_at(dof, point), state.angular[dof];
  }
  return jacobian;
}

// A configuration with one changed degree of freedom of the tree.
std::vector<double> moved(const Robot& robot, std::vector<double> qpos, int dof, double by) {
  if (dof < 3) {
    qpos[dof] += by;
  } else if (dof < KinematicTree::kBaseDofs) {
    const Eigen::Quaterniond q = Eigen::Quaterniond(qpos[3], qpos[4], qpos[5], qpos[6]) *
                                 exp_so3(by * Vector3d::Unit(dof - 3));
    qpos[3] = q.w();
    for (int k = 0; k < 3; ++k) qpos[4 + k] = q.vec()[k];
  } else {
    qpos[robot.tree().links()[dof - KinematicTree::dof_of(0)].qpos_address] += by;
  }
  return qpos;
}

// Rows over carriers as a full matrix.
MatrixXd dense(const KinematicTree& tree, const std::vector<double>& rows) {
  const int dofs = tree.dof_count();
  MatrixXd matrix = MatrixXd::Constant(dofs, dofs, 1e30);
  // Writes rows by column and thereby fills the upper triangle.
  write_lower_triangle(tree, rows, matrix.data(), dofs);
  return matrix.selfadjointView<Eigen::Upper>();
}

TEST(KinematicTreeTest, PosesAnchorsAndAxesMatchMujoco) {
  for (const auto& robot : robots()) {
    std::mt19937 random(3);
    TreeState state(robot->tree());
    double worst = 0.0;
    for (int round = 0; round < 20; ++round) {
      const std::vector<double> qpos = random_configuration(*robot, random);
      const auto theirs = mujoco_kinematics(*robot->model(), qpos);
      const Reference reference(*robot, qpos);
      state.update(qpos);
      for (std::size_t b = 0; b < theirs.size(); ++b) {
        worst = std::max(worst, difference(state.world_from_body(static_cast<int>(b)), theirs[b]));
      }
      for (int j = 0; j < static_cast<int>(robot->joints().size()); ++j) {
        worst = std::max(worst, (state.axis(j) - reference.axis(j)).norm());
        // Only the position across the axis is compared: MuJoCo reports a slide's anchor before its
        // movement.
        const Vector3d apart = state.anchor(j) - reference.anchor(j);
        worst = std::max(worst, state.slides(j) ? apart.cross(state.axis(j)).norm() : apart.norm());
      }
    }
    EXPECT_LT(worst, 1e-12) << robot->name();
  }
}

TEST(KinematicTreeTest, MotionSubspacesMatchMujocosJacobian) {
  for (const auto& robot : robots()) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    double worst = 0.0;
    for (int round = 0; round < 5; ++round) {
      const std::vector<double> qpos = random_configuration(*robot, random);
      const TreeState state(robot->tree(), qpos);
      const Reference reference(*robot, qpos);
      for (std::size_t b = 0; b < robot->bodies().size(); ++b) {
        const int body = static_cast<int>(b);
        const Vector3d point(normal(random), normal(random), normal(random));
        const Matrix6Xd own = own_jacobian(state, body, point);
        const Matrix6Xd theirs = reference.jacobian(body, point);
        for (int dof = 0; dof < state.tree->dof_count(); ++dof) {
          const auto difference = own.col(dof) - theirs.col(mujoco_dof(*robot, dof));
          worst = std::max(worst, difference.cwiseAbs().maxCoeff());
        }
      }
    }
    EXPECT_LT(worst, 1e-11) << robot->name();
  }
}

TEST(KinematicTreeTest, MotionSubspacesAreFiniteDifferencesOfThePoses) {
  constexpr double kStep = 1e-6;
  for (const auto& robot : robots()) {
    std::mt19937 random(7);
    const std::vector<double> qpos = random_configuration(*robot, random);
    const TreeState state(robot->tree(), qpos);
    const Vector3d in_body(0.1, -0.2, 0.3);
    double worst = 0.0;
    for (int dof = 0; dof < state.tree->dof_count(); ++dof) {
      const TreeState above(robot->tree(), moved(*robot, qpos, dof, kStep));
      const TreeState below(robot->tree(), moved(*robot, qpos, dof, -kStep));
      for (int body = 1; body < static_cast<int>(robot->bodies().size()); ++body) {
        const Pose before = below.world_from_body(body), after = above.world_from_body(body);
        const Vector3d linear = (after * in_body - before * in_body) / (2.0 * kStep);
        const Vector3d angular =
            log_so3(after.rotation * before.rotation.conjugate()) / (2.0 * kStep);
        const Matrix6Xd own = own_jacobian(state, body, state.world_from_body(body) * in_body);
        worst = std::max(worst, (own.col(dof).head<3>() - linear).norm());
        worst = std::max(worst, (own.col(dof).tail<3>() - angular).norm());
      }
    }
    EXPECT_LT(worst, 1e-7) << robot->name();
  }
}

// Random forms on every link: H = sum J'AJ and g = sum J'b with MuJoCo's Jacobians of the links'
// bodies at the base's origin.
TEST(CompositeTest, HessianAndGradientMatchMujocosJacobians) {
  for (const auto& robot : robots()) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    const auto noise = [&] { return normal(random); };
    const std::vector<double> qpos = random_configuration(*robot, random);
    const KinematicTree& tree = robot->tree();
    const TreeState state(tree, qpos);
    const Reference reference(*robot, qpos);
    const auto nv = reference.jacobian(0, Vector3d::Zero()).cols();
    MatrixXd expected = MatrixXd::Zero(nv, nv);
    VectorXd expected_gradient = VectorXd::Zero(nv);
    std::vector<Composite> composites(tree.links().size());
    for (std::size_t link = 0; link < composites.size(); ++link) {
      // The last joint of a body carries everything that moves with the body.
      const int body = tree.links()[link].body;
      if (tree.attachment(body).link != static_cast<int>(link)) continue;
      const Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::NullaryExpr(noise);
      const Eigen::Matrix<double, 6, 6> a = root.transpose() * root;
      const Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::NullaryExpr(noise);
      composites[link].linear = a.topLeftCorner<3, 3>();
      composites[link].mixed = a.topRightCorner<3, 3>();
      composites[link].angular = a.bottomRightCorner<3, 3>();
      composites[link].force = b.head<3>();
      composites[link].torque = b.tail<3>();
      const Matrix6Xd jacobian = reference.jacobian(body, state.origin());
      expected += jacobian.transpose() * a * jacobian;
      expected_gradient += jacobian.transpose() * b;
    }
    std::vector<double> rows(tree.row_begin().back(), 1e30), gradient(tree.dof_count(), 1e30);
    assemble(state, composites, rows, gradient);
    const MatrixXd hessian = dense(tree, rows);
    const double scale = expected.cwiseAbs().maxCoeff();
    for (int i = 0; i < tree.dof_count(); ++i) {
      const int row = mujoco_dof(*robot, i);
      EXPECT_NEAR(gradient[i], expected_gradient[row], 1e-12 * scale) << robot->name() << " " << i;
      for (int j = 0; j < tree.dof_count(); ++j) {
        EXPECT_NEAR(hessian(i, j), expected(row, mujoco_dof(*robot, j)), 1e-12 * scale)
            << robot->name() << " " << i << " " << j;
      }
    }
  }
}

// Half the squared distances of points from their start: near it the gradient matches the cost, and
// the Hessian matches its change at zero.
TEST(CompositeTest, HessianAndGradientAreFiniteDifferencesOfACost) {
  constexpr double kStep = 1e-6;
  for (const auto& robot : robots()) {
    std::mt19937 random(13);
    const std::vector<double> qpos = random_configuration(*robot, random);
    const KinematicTree& tree = robot->tree();
    const int bodies = static_cast<int>(robot->bodies().size());
    const Vector3d in_body(0.05, 0.1, -0.1);
    const TreeState wanted(tree, qpos);
    const auto error = [&](const TreeState& state, int body) -> Vector3d {
      return state.world_from_body(body) * in_body - wanted.world_from_body(body) * in_body;
    };
    const auto cost = [&](const std::vector<double>& at) {
      const TreeState state(tree, at);
      double sum = 0.0;
      for (int body = 1; body < bodies; ++body) sum += 0.5 * error(state, body).squaredNorm();
      return sum;
    };
    std::vector<double> rows(tree.row_begin().back()), gradient(tree.dof_count());
    const auto assemble_at = [&](const std::vector<double>& at) {
      const TreeState state(tree, at);
      std::vector<Composite> composites(tree.links().size());
      for (int body = 1; body < bodies; ++body) {
        const int link = tree.attachment(body).link;
        if (link == KinematicTree::kWorld) continue;
        const Vector3d arm = state.world_from_body(body) * in_body - state.origin();
        const Matrix3d cross = skew(arm);
        Composite& sum = composites[link];
        sum.linear += Matrix3d::Identity();
        sum.mixed -= cross;
        sum.angular -= cross * cross;
        sum.force += error(state, body);
        sum.torque += arm.cross(error(state, body));
      }
      assemble(state, composites, rows, gradient);
    };
    std::vector<double> away = qpos;
    for (int dof = 0; dof < tree.dof_count(); ++dof) away = moved(*robot, away, dof, 0.02);
    assemble_at(away);
    const double scale = *std::ranges::max_element(gradient);
    for (int dof = 0; dof < tree.dof_count(); ++dof) {
      const double change =
          cost(moved(*robot, away, dof, kStep)) - cost(moved(*robot, away, dof, -kStep));
      EXPECT_NEAR(gradient[dof], change / (2.0 * kStep), 1e-7 * (1.0 + scale)) << robot->name();
    }
    assemble_at(qpos);
    const MatrixXd hessian = dense(tree, rows);
    for (int dof = 0; dof < tree.dof_count(); ++dof) {
      assemble_at(moved(*robot, qpos, dof, kStep));
      const VectorXd change = Eigen::Map<const VectorXd>(gradient.data(), tree.dof_count()) / kStep;
      EXPECT_LT((hessian.col(dof) - change).norm(), 1e-4 * hessian.norm()) << robot->name();
    }
  }
}

TEST(KinematicTreeTest, MergesFixedBodies) {
  const auto robot = robot_from_text(kOddRobot);
  const KinematicTree& tree = robot->tree();
  const auto body = [&](const char* name) { return robot->find_body(name).value(); };
  ASSERT_EQ(tree.links().size(), 7U);
  EXPECT_EQ(tree.dof_count(), 12);
  EXPECT_EQ(tree.links()[0].body, body("base"));
  EXPECT_EQ(tree.links()[0].parent, KinematicTree::kWorld);
  EXPECT_EQ(tree.links()[0].last_descendant, 6);
  EXPECT_EQ(tree.attachment(body("stand")).link, KinematicTree::kWorld);
  EXPECT_EQ(tree.attachment(body("post")).link, 0);
  // The four joints of the hand in sequence; the tip hangs from the last.
  for (int link = 1; link <= 4; ++link) {
    EXPECT_EQ(tree.links()[link].body, body("hand"));
    EXPECT_EQ(tree.links()[link].parent, link - 1);
    EXPECT_EQ(tree.links()[link].last_descendant, 5);
    EXPECT_EQ(tree.link_of_joint(link - 1), link);
  }
  EXPECT_EQ(tree.attachment(body("tip")).link, 4);
  EXPECT_EQ(tree.links()[5].parent, 4);
  EXPECT_EQ(tree.links()[6].parent, 0);
  EXPECT_THAT(tree.children(0), ElementsAre(1, 6));
  EXPECT_THAT(tree.children(4), ElementsAre(5));
  EXPECT_THAT(tree.children(6), IsEmpty());
  EXPECT_EQ(tree.carrier(body("tip")), body("hand"));
  EXPECT_EQ(tree.carrier(body("hand")), body("hand"));
  EXPECT_EQ(tree.carrier(body("stand")), 0);
  EXPECT_THAT(tree.rigid_group(body("base")), ElementsAre(body("base"), body("post")));
  EXPECT_THAT(tree.rigid_group(body("hand")), ElementsAre(body("hand"), body("tip")));
  EXPECT_TRUE(tree.carries(1, 5));
  EXPECT_TRUE(tree.carries(5, 5));
  EXPECT_FALSE(tree.carries(1, 6));
  EXPECT_FALSE(tree.carries(0, KinematicTree::kWorld));
  EXPECT_THAT(tree.carriers(11), ElementsAre(0, 1, 2, 3, 4, 5, 11));
  EXPECT_THAT(tree.carriers(10), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10));
}

TEST(KinematicTreeTest, OmitsJointsThatMoveNoRequestedBody) {
  const auto robot = load_shipped("unitree_g1");
  const std::array bodies = {robot->find_body("left_knee_link").value(),
                             robot->find_body("right_elbow_link").value()};
  const KinematicTree tree(*robot, bodies);
  EXPECT_LT(tree.links().size(), robot->tree().links().size());
  std::set<int> carrying;
  for (const int body : bodies) {
    for (int at = body; at > 0; at = robot->bodies()[at].parent) carrying.insert(at);
  }
  for (int j = 0; j < static_cast<int>(robot->joints().size()); ++j) {
    const bool kept = tree.link_of_joint(j) != KinematicTree::kWorld;
    EXPECT_EQ(kept, carrying.contains(robot->joints()[j].body)) << robot->joints()[j].name;
    if (!kept) continue;
    EXPECT_EQ(tree.links()[tree.link_of_joint(j)].joint, j);
  }
  std::mt19937 random(17);
  const std::vector<double> qpos = random_configuration(*robot, random);
  const TreeState some(tree, qpos), all(robot->tree(), qpos);
  for (const int body : bodies) {
    EXPECT_LT(difference(some.world_from_body(body), all.world_from_body(body)), 1e-14);
  }
}

TEST(KinematicTreeTest, CommonPointIsWhereAxesMeet) {
  const auto robot = robot_from_text(R"(
<mujoco><worldbody><body name="base"><freejoint/><geom size="1"/>
  <body pos="1 2 3"><joint axis="1 0 0" pos="0.001 0 0"/><geom size="1"/>
    <body><joint axis="0 1 1"/><geom size="1"/>
      <body><joint axis="0 0 1" pos="0 0 -0.001"/><geom size="1"/>
        <body pos="0 0 1"><joint type="slide" axis="1 0 0"/><geom size="1"/></body>
      </body></body></body>
</body></worldbody></mujoco>)");
  const TreeState state(robot->tree(), robot->zero_configuration());
  // Pulled to the anchors by one hundredth.
  EXPECT_LT((common_point(state, std::array{0, 1, 2}) - Vector3d(1, 2, 3)).norm(), 1e-5);
  EXPECT_LT((common_point(state, std::array{3}) - Vector3d(1, 2, 4)).norm(), 1e-12);
  EXPECT_LT((common_point(state, std::array{1}) - Vector3d(1, 2, 3)).norm(), 1e-12);
}

}  // namespace
}  // namespace retarget
