// Properties of every robot in the repository, whatever its source format.

#include "shipped_robots.h"

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "retarget/robot.h"
#include "robot_kinematics.h"
#include "support/value_of.h"

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
    poses_ = own_kinematics(*robot_, robot_->zero_configuration());
  }

  std::shared_ptr<const Robot> robot_;
  std::vector<Pose> poses_;  // Poses in the zero configuration.
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
  constexpr double kOverlap = 0.01;  // Smaller overlaps are within the shapes' own tolerance.
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
    const auto limits = value_of(load_limits(*robot_, name));
    for (std::size_t j = 0; j < robot_->joints().size(); ++j) {
      EXPECT_LE(limits.lower[j], 0.0) << name << ", " << robot_->joints()[j].name;
      EXPECT_GE(limits.upper[j], 0.0) << name << ", " << robot_->joints()[j].name;
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

// The body of the H2 Plus has the values of the H2, which come from another file.
TEST(ShippedRobotsFigures, TheH2PlusHasTheBodyOfTheH2) {
  const auto h2 = load_shipped("unitree_h2"), plus = load_shipped("unitree_h2_plus");
  const std::vector<Pose> poses = own_kinematics(*h2, h2->zero_configuration());
  const std::vector<Pose> theirs = own_kinematics(*plus, plus->zero_configuration());
  for (std::size_t b = 1; b < h2->bodies().size(); ++b) {
    const std::string& name = h2->bodies()[b].name;
    const auto body = plus->find_body(name);
    ASSERT_TRUE(body) << name;
    const Pose difference =
        (theirs[1].inverse() * theirs[*body]).inverse() * (poses[1].inverse() * poses[b]);
    EXPECT_LT(difference.translation.norm(), 1e-7) << name;
    EXPECT_LT(difference.rotation.vec().norm(), 1e-7) << name;
    if (name.find("wrist_yaw") != std::string::npos) continue;  // It carries another hand.
    EXPECT_NEAR(h2->model()->body_mass[b], plus->model()->body_mass[*body], 1e-9) << name;
  }
  for (std::size_t j = 0; j < h2->joints().size(); ++j) {
    const auto joint = plus->find_joint(h2->joints()[j].name);
    ASSERT_TRUE(joint) << h2->joints()[j].name;
    EXPECT_EQ(h2->model_limits().lower[j], plus->model_limits().lower[*joint]);
    EXPECT_EQ(h2->model_limits().upper[j], plus->model_limits().upper[*joint]);
  }
}

// The makers' left and right sides are mirror images, except for fractions of a millimetre.
TEST(ShippedRobotsFigures, SidesAreMirrorImages) {
  const std::map<std::string, std::pair<std::string, std::string>> sides = {
      {"engineai_t800", {"_L", "_R"}},
      {"hightorque_pi_plus", {"l_", "r_"}},
      {"unitree_h2_plus", {"left_", "right_"}}};
  for (const auto& [name, words] : sides) {
    const auto robot = load_shipped(name);
    const std::vector<Pose> poses = own_kinematics(*robot, robot->zero_configuration());
    const Pose base = poses[1];
    int compared = 0;
    for (std::size_t b = 1; b < robot->bodies().size(); ++b) {
      std::string other = robot->bodies()[b].name;
      const bool at_end = words.first.front() == '_';
      if (!(at_end ? other.ends_with(words.first) : other.starts_with(words.first))) continue;
      other.replace(at_end ? other.size() - words.first.size() : 0, words.first.size(),
                    words.second);
      const auto mirrored = robot->find_body(other);
      ASSERT_TRUE(mirrored) << name << ": " << other;
      const Eigen::Vector3d left = base.inverse() * poses[b].translation;
      Eigen::Vector3d right = base.inverse() * poses[*mirrored].translation;
      right.y() = -right.y();
      EXPECT_LT((left - right).norm(), 2e-3) << name << ": " << other;
      EXPECT_NEAR(robot->model()->body_mass[b], robot->model()->body_mass[*mirrored], 0.04)
          << other;
      ++compared;
    }
    EXPECT_GE(compared, 11) << name;
  }
}

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
