// Properties of every robot in the repository, whatever its source format.

#include "shipped_robots.h"

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>

#include "retarget/robot.h"
#include "robot_kinematics.h"

namespace retarget {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;

// The values are rounded to tenths of a millimetre.
constexpr double kRounding = 2e-4;
// Between the left and the right sole.
constexpr double kFeetDiffer = 4e-4;

// The height of the lowest point of a shape.
double lowest_point(const CollisionShape& shape, const Pose& world_from_body) {
  const Pose world = world_from_body * shape.body_from_shape;
  const Eigen::RowVector3d up = world.rotation.toRotationMatrix().row(2);
  const double extent = shape.type == CollisionShape::Type::kBox
                            ? up.cwiseAbs().dot(shape.half_size)
                            : std::abs(up.z()) * shape.half_length + shape.radius;
  return world.translation.z() - extent;
}

class ShippedRobots : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    robot_ = load_shipped(GetParam());
    ASSERT_NE(robot_, nullptr);
    poses_ = own_kinematics(*robot_, robot_->zero_configuration());
  }

  std::shared_ptr<const Robot> robot_;
  std::vector<Pose> poses_;  // of the zero configuration
};

TEST_P(ShippedRobots, HaveDescriptionAndSource) {
  EXPECT_EQ(robot_->name(), GetParam());
  EXPECT_THAT(robot_->warnings(), IsEmpty());
  EXPECT_THAT(robot_->profile().description, Not(IsEmpty()));
  EXPECT_THAT(robot_->profile().source, Not(IsEmpty()));
  EXPECT_THAT(robot_->profile().licence, Not(IsEmpty()));
  EXPECT_THAT(robot_->profile().speed_limits_source, Not(IsEmpty()));
  // All joints are output columns.
  EXPECT_EQ(robot_->output_joints().size(), robot_->joints().size());
}

TEST_P(ShippedRobots, SolesAreLevelAndLowestAtTheZeroPose) {
  ASSERT_EQ(robot_->profile().soles.size(), 2U);
  const Sole& left = robot_->profile().soles[0];
  EXPECT_EQ(left.side, "left");
  double floor = (poses_[left.body] * left.points[0]).z();
  for (const Sole& sole : robot_->profile().soles) {
    ASSERT_GE(sole.points.size(), 4U);
    EXPECT_EQ(sole.points.size(), sole.labels.size());
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3d& point : sole.points) points.push_back(poses_[sole.body] * point);
    EXPECT_NEAR(points[0].z(), floor, kFeetDiffer);
    for (const Eigen::Vector3d& point : points) EXPECT_NEAR(point.z(), points[0].z(), kRounding);
    floor = std::min(floor, points[0].z());
    // Heel left, heel right, toe left, toe right of a robot that faces +x.
    EXPECT_GT(points[2].x(), points[0].x() + 0.1);
    EXPECT_GT(points[3].x(), points[1].x() + 0.1);
    EXPECT_GT(points[0].y(), points[1].y());
    EXPECT_GT(points[2].y(), points[3].y());
    EXPECT_EQ(points[0].y() > 0.0, sole.side == "left");
  }
  for (const CollisionShape& shape : robot_->collision_shapes()) {
    EXPECT_GT(lowest_point(shape, poses_[shape.body]), floor - kRounding)
        << robot_->bodies()[shape.body].name;
  }
}

TEST_P(ShippedRobots, EveryMovingBodyHasShapes) {
  std::set<int> bodies;
  for (const CollisionShape& shape : robot_->collision_shapes()) bodies.insert(shape.body);
  for (const RobotJoint& joint : robot_->joints()) {
    EXPECT_TRUE(bodies.contains(joint.body)) << joint.name;
  }
  // Every contact geom of MuJoCo is among the shapes, so there are no other kinds.
  EXPECT_EQ(robot_->collision_shapes().size(), static_cast<std::size_t>(robot_->model()->ngeom));
}

TEST_P(ShippedRobots, SelfContactsAtTheZeroPoseAreAllowed) {
  const mjModel& model = *robot_->model();
  const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&model), mj_deleteData);
  mj_kinematics(&model, data.get());
  std::set<std::pair<int, int>> allowed;
  for (const auto& [a, b] : robot_->profile().allowed_self_contact) {
    allowed.emplace(std::min(a, b), std::max(a, b));
  }
  constexpr double kOverlap = 0.01;  // less is within the shapes' own tolerance
  for (int first = 0; first < model.ngeom; ++first) {
    for (int second = first + 1; second < model.ngeom; ++second) {
      const int a = model.geom_bodyid[first], b = model.geom_bodyid[second];
      if (a == b || allowed.contains({std::min(a, b), std::max(a, b)})) continue;
      EXPECT_GT(mj_geomDistance(&model, data.get(), first, second, 0.0, nullptr), -kOverlap)
          << robot_->bodies()[a].name << " and " << robot_->bodies()[b].name;
    }
  }
}

TEST_P(ShippedRobots, CanStandAtTheZeroPoseUnderEveryLimitSet) {
  std::vector<std::string> sets = {"model", robot_->limits_for("gmr"), robot_->limits_for("fit")};
  for (const LimitSet& set : robot_->profile().limit_sets) sets.push_back(set.name);
  for (const std::string& name : sets) {
    const auto limits = load_limits(*robot_, name);
    ASSERT_TRUE(limits.has_value()) << describe(limits.error());
    for (std::size_t j = 0; j < robot_->joints().size(); ++j) {
      EXPECT_LE(limits->lower[j], 0.0) << name << ", " << robot_->joints()[j].name;
      EXPECT_GE(limits->upper[j], 0.0) << name << ", " << robot_->joints()[j].name;
    }
  }
}

TEST_P(ShippedRobots, HaveASpeedLimitForEveryJoint) {
  for (std::size_t j = 0; j < robot_->joints().size(); ++j) {
    const auto& published = robot_->profile().speed_limits;
    const auto found = published.find(robot_->joints()[j].name);
    EXPECT_EQ(robot_->speed_limit(static_cast<int>(j)),
              found == published.end() ? 20.0 : found->second);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShippedRobots, testing::ValuesIn(list_robots({robots_folder()})),
                         [](const auto& robot) { return robot.param; });

TEST(ShippedRobotsList, ContainsTheKnownRobots) {
  const std::vector<std::string> known = {"agibot_x2",
                                          "berkeley_humanoid_lite",
                                          "booster_k1",
                                          "booster_t1",
                                          "booster_t1_29dof",
                                          "engineai_pm01",
                                          "engineai_t800",
                                          "fourier_gr3",
                                          "fourier_n1",
                                          "hightorque_hi",
                                          "hightorque_pi_plus",
                                          "kuavo_s45",
                                          "limx_oli",
                                          "pal_talos",
                                          "pnd_adam_lite",
                                          "stanford_toddy",
                                          "tienkung",
                                          "unitree_g1",
                                          "unitree_g1_with_hands",
                                          "unitree_h1",
                                          "unitree_h1_2",
                                          "unitree_h2",
                                          "unitree_h2_plus",
                                          "unitree_r1"};
  EXPECT_THAT(list_robots({robots_folder()}), testing::IsSupersetOf(known));
}

}  // namespace
}  // namespace retarget
