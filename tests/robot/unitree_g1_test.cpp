// Our mesh-free G1 against the figures that it was written from.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <sstream>

#include "retarget/robot/limits.h"
#include "retarget/robot/load_robot.h"
#include "robot_kinematics.h"
#include "support/shared_data.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

constexpr double kTolerance = 1e-12;

std::string read_text(const fs::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

class UnitreeG1Test : public testing::Test {
 protected:
  void SetUp() override { ASSERT_NE(g1_, nullptr); }

  std::shared_ptr<const Robot> g1_ = load_g1();
};

TEST_F(UnitreeG1Test, TwentyNineJointsInPublishedOrder) {
  EXPECT_EQ(g1_->name(), "unitree_g1");
  EXPECT_EQ(g1_->bodies()[g1_->root_body()].name, "pelvis");
  EXPECT_EQ(g1_->output_joints().size(), 29U);
  // as in the published data: legs left and right, waist, arms left and right
  const auto name = [&](int column) { return g1_->joints()[g1_->output_joints()[column]].name; };
  EXPECT_EQ(name(0), "left_hip_pitch_joint");
  EXPECT_EQ(name(6), "right_hip_pitch_joint");
  EXPECT_EQ(name(12), "waist_yaw_joint");
  EXPECT_EQ(name(15), "left_shoulder_pitch_joint");
  EXPECT_EQ(name(28), "right_wrist_yaw_joint");
  EXPECT_EQ(g1_->limits_for("gmr"), "gmr");
  EXPECT_EQ(g1_->limits_for("fit"), "official");
  EXPECT_THAT(g1_->warnings(), IsEmpty());
}

TEST_F(UnitreeG1Test, SolesAreLevelAtTheZeroPoseAndMirrored) {
  const auto poses = own_kinematics(*g1_, g1_->zero_configuration());
  ASSERT_EQ(g1_->profile().soles.size(), 2U);
  for (const Sole& sole : g1_->profile().soles) {
    EXPECT_EQ(sole.points.size(), sole.labels.size());
    for (const Eigen::Vector3d& point : sole.points) {
      // the pelvis stands 0.7923 m above the soles, and at 0.793 m in the zero configuration
      EXPECT_NEAR((poses[sole.body] * point).z(), 0.793 - 0.7923, 1e-4);
    }
    const double heel = (poses[sole.body] * sole.points[0]).x();
    const double toe = (poses[sole.body] * sole.points[2]).x();
    EXPECT_GT(toe, heel + 0.15);
    // left of the foot is first, for both feet
    EXPECT_GT(sole.points[0].y(), sole.points[1].y());
  }
}

TEST_F(UnitreeG1Test, EveryMovingBodyHasShapes) {
  EXPECT_EQ(g1_->collision_shapes().size(), 66U);
  std::vector<bool> has_shape(g1_->bodies().size(), false);
  for (const CollisionShape& shape : g1_->collision_shapes()) has_shape[shape.body] = true;
  for (const RobotJoint& joint : g1_->joints()) EXPECT_TRUE(has_shape[joint.body]) << joint.name;
}

TEST_F(UnitreeG1Test, LoadsInMilliseconds) {
  const auto start = std::chrono::steady_clock::now();
  constexpr int kTimes = 20;
  for (int i = 0; i < kTimes; ++i) load_g1();
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
  RecordProperty("load_ms", std::to_string(taken.count() / kTimes));
  // 3 ms when it is quiet; with meshes it would be hundreds
  EXPECT_LT(taken.count() / kTimes, 200.0);
}

// the files that the figures come from
class UnitreeG1FiguresTest : public UnitreeG1Test {
 protected:
  void SetUp() override {
    UnitreeG1Test::SetUp();
    const auto shared = shared_folder();
    if (!shared) GTEST_SKIP() << kNoSharedFolder;
    folder_ = *shared / "reference" / "robots" / "unitree_g1";
  }

  [[nodiscard]] std::shared_ptr<const Robot> reference(const std::string& name) const {
    const auto robot = load_robot((folder_ / name).string());
    EXPECT_TRUE(robot.has_value()) << describe(robot.error());
    return robot ? *robot : nullptr;
  }

  fs::path folder_;
};

TEST_F(UnitreeG1FiguresTest, TreeAndJointsAreTheReferences) {
  const auto reference = this->reference("g1_mocap_29dof.xml");
  ASSERT_NE(reference, nullptr);
  EXPECT_THAT(g1_->body_names(), ElementsAreArray(reference->body_names()));
  EXPECT_THAT(g1_->joint_names(), ElementsAreArray(reference->joint_names()));
  EXPECT_THAT(g1_->zero_configuration(), ElementsAreArray(reference->zero_configuration()));
  for (std::size_t b = 0; b < g1_->bodies().size(); ++b) {
    const RobotBody& ours = g1_->bodies()[b];
    const RobotBody& theirs = reference->bodies()[b];
    EXPECT_EQ(ours.parent, theirs.parent) << ours.name;
    EXPECT_EQ(ours.parent_from_body.translation, theirs.parent_from_body.translation) << ours.name;
    EXPECT_EQ(ours.parent_from_body.rotation.coeffs(), theirs.parent_from_body.rotation.coeffs())
        << ours.name;
  }
  for (std::size_t j = 0; j < g1_->joints().size(); ++j) {
    const RobotJoint& ours = g1_->joints()[j];
    const RobotJoint& theirs = reference->joints()[j];
    EXPECT_EQ(ours.type, theirs.type) << ours.name;
    EXPECT_EQ(ours.body, theirs.body) << ours.name;
    EXPECT_EQ(ours.axis, theirs.axis) << ours.name;
    EXPECT_EQ(ours.anchor, theirs.anchor) << ours.name;
  }
}

TEST_F(UnitreeG1FiguresTest, MassesAreTheReferences) {
  const auto reference = this->reference("g1_mocap_29dof.xml");
  ASSERT_NE(reference, nullptr);
  const mjModel& ours = *g1_->model();
  const mjModel& theirs = *reference->model();
  for (int b = 0; b < ours.nbody; ++b) {
    const std::string& name = g1_->bodies()[b].name;
    // hands weigh nothing of their own: theirs is in the wrist
    EXPECT_EQ(ours.body_mass[b], theirs.body_mass[b]) << name;
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(ours.body_ipos[3 * b + i], theirs.body_ipos[3 * b + i]) << name;
      EXPECT_EQ(ours.body_inertia[3 * b + i], theirs.body_inertia[3 * b + i]) << name;
    }
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(ours.body_iquat[4 * b + i], theirs.body_iquat[4 * b + i]) << name;
    }
  }
}

TEST_F(UnitreeG1FiguresTest, KinematicsAreThoseOfBothReferences) {
  std::mt19937 random(29);
  for (const char* file : {"g1_mocap_29dof.xml", "g1_29dof_rev_1_0.xml"}) {
    const auto reference = this->reference(file);
    ASSERT_NE(reference, nullptr);
    double worst = 0.0;
    for (int i = 0; i < 100; ++i) {
      const std::vector<double> qpos = random_configuration(*g1_, random);
      const auto ours = own_kinematics(*g1_, qpos);
      const auto theirs = mujoco_kinematics(*reference->model(), qpos);
      for (std::size_t b = 0; b < theirs.size(); ++b) {
        const auto body = g1_->find_body(reference->bodies()[b].name);
        ASSERT_TRUE(body.has_value()) << reference->bodies()[b].name;
        worst = std::max(worst, difference(ours[*body], theirs[b]));
      }
    }
    EXPECT_LT(worst, kTolerance) << file;
  }
}

TEST_F(UnitreeG1FiguresTest, LimitSetsHaveTheReferencesDigits) {
  const std::map<std::string, std::string> sources = {{"official", "g1_29dof_rev_1_0.xml"},
                                                      {"model", "g1_29dof_rev_1_0.xml"},
                                                      {"gmr", "g1_mocap_29dof.xml"}};
  for (const auto& [set, file] : sources) {
    const auto reference = this->reference(file);
    const auto limits = load_limits(*g1_, set);
    ASSERT_TRUE(limits.has_value());
    EXPECT_THAT(limits->lower, ElementsAreArray(reference->model_limits().lower)) << set;
    EXPECT_THAT(limits->upper, ElementsAreArray(reference->model_limits().upper)) << set;
  }
}

TEST_F(UnitreeG1FiguresTest, SpeedLimitsAreThoseOfTheUrdf) {
  const std::string urdf = read_text(folder_ / "g1_29dof_rev_1_0.urdf");
  const std::regex pattern(
      R"re(<joint\s+name="([^"]+)"\s+type="revolute">[\s\S]*?velocity="([^"]+)")re");
  std::map<std::string, double> speeds;
  for (auto match = std::sregex_iterator(urdf.begin(), urdf.end(), pattern);
       match != std::sregex_iterator(); ++match) {
    speeds[(*match)[1]] = std::stod((*match)[2]);
  }
  EXPECT_EQ(speeds.size(), 29U);
  EXPECT_EQ(g1_->profile().speed_limits, speeds);
}

// a shape as a list of figures: its ends and radius, or its centre, axes and half size
std::vector<double> figures_of(const CollisionShape& shape) {
  const Eigen::Vector3d up(0, 0, shape.half_length);
  const Pose& pose = shape.body_from_shape;
  std::vector<double> figures;
  const auto add = [&](const Eigen::Vector3d& v) {
    figures.insert(figures.end(), v.data(), v.data() + 3);
  };
  if (shape.type == CollisionShape::Type::kBox) {
    add(pose.translation);
    for (int i = 0; i < 3; ++i) add(pose.rotation.toRotationMatrix().col(i));
    add(shape.half_size);
  } else {
    // which end is the first does not matter
    add((pose * up).cwiseMin(pose * -up));
    add((pose * up).cwiseMax(pose * -up));
    figures.push_back(shape.radius);
  }
  return figures;
}

CollisionShape shape_from_json(const nlohmann::json& json) {
  const auto vector = [&](const char* key) {
    return Eigen::Vector3d(json.at(key)[0], json.at(key)[1], json.at(key)[2]);
  };
  CollisionShape shape;
  const std::string type = json.at("type");
  if (type == "sphere") {
    shape.body_from_shape.translation = vector("center");
    shape.radius = json.at("radius");
  } else if (type == "capsule") {
    shape.type = CollisionShape::Type::kCapsule;
    const Eigen::Vector3d from = vector("from"), to = vector("to");
    shape.body_from_shape = {
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), to - from), (from + to) / 2};
    shape.half_length = (to - from).norm() / 2;
    shape.radius = json.at("radius");
  } else {
    shape.type = CollisionShape::Type::kBox;
    const auto& q = json.at("quat_wxyz");
    shape.body_from_shape = {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized(),
                             vector("center")};
    shape.half_size = vector("half_size");
  }
  return shape;
}

TEST_F(UnitreeG1FiguresTest, ShapesSolesAndContactsAreTheFittedOnes) {
  const auto json = nlohmann::json::parse(read_text(folder_ / "collision.json"));
  std::map<std::string, std::vector<CollisionShape>> shapes;
  for (const CollisionShape& shape : g1_->collision_shapes()) {
    shapes[g1_->bodies()[shape.body].name].push_back(shape);
  }
  EXPECT_EQ(shapes.size(), json.at("bodies").size());
  for (const auto& [body, primitives] : json.at("bodies").items()) {
    ASSERT_EQ(shapes[body].size(), primitives.size()) << body;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const CollisionShape expected = shape_from_json(primitives[i]);
      EXPECT_EQ(shapes[body][i].type, expected.type) << body;
      EXPECT_THAT(figures_of(shapes[body][i]),
                  ::testing::Pointwise(::testing::DoubleNear(1e-12), figures_of(expected)))
          << body;
    }
  }
  for (const Sole& sole : g1_->profile().soles) {
    const auto& expected = json.at("soles").at(sole.side);
    EXPECT_EQ(g1_->bodies()[sole.body].name, expected.at("body"));
    EXPECT_EQ(nlohmann::json(sole.labels), expected.at("labels"));
    ASSERT_EQ(sole.points.size(), expected.at("points").size());
    for (std::size_t i = 0; i < sole.points.size(); ++i) {
      const auto& point = expected.at("points")[i];
      EXPECT_EQ(sole.points[i], Eigen::Vector3d(point[0], point[1], point[2]));
    }
  }
  auto pairs = nlohmann::json::array();
  for (const auto& [a, b] : g1_->profile().allowed_self_contact) {
    pairs.push_back({g1_->bodies()[a].name, g1_->bodies()[b].name});
  }
  EXPECT_EQ(pairs, json.at("allowed_self_contact"));
}

}  // namespace
}  // namespace retarget
