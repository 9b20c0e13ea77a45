// Tree, forward kinematics and shapes of a robot, against MuJoCo and values computed by hand.

#include "retarget/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>
#include <limits>
#include <random>

#include "retarget/load_robot.h"
#include "retarget/motion.h"
#include "robot_kinematics.h"
#include "support/shared_data.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr double kPoseTolerance = 1e-12;

void expect_mujoco_agrees(const Robot& robot, int configurations) {
  std::mt19937 random(17);
  double worst = 0.0;
  for (int i = 0; i < configurations; ++i) {
    const std::vector<double> qpos = random_configuration(robot, random);
    const auto own = own_kinematics(robot, qpos);
    const auto theirs = mujoco_kinematics(*robot.model(), qpos);
    for (std::size_t b = 0; b < own.size(); ++b) {
      worst = std::max(worst, difference(own[b], theirs[b]));
    }
  }
  EXPECT_LT(worst, kPoseTolerance) << robot.name();
}

TEST(RobotTest, TreeMatchesTheModel) {
  const auto robot = robot_from_text(kTwoArms);
  EXPECT_THAT(robot->body_names(),
              ElementsAre("world", "base", "left_upper", "left_lower", "right_upper"));
  EXPECT_EQ(robot->root_body(), 1);
  EXPECT_EQ(robot->find_body("left_lower"), 3);
  EXPECT_EQ(robot->bodies()[3].parent, 2);
  EXPECT_EQ(robot->find_body("left"), std::nullopt);
  EXPECT_THAT(robot->joint_names(), ElementsAre("left_shoulder", "left_elbow", "left_twist",
                                                "right_slide", "right_shoulder"));
  EXPECT_EQ(robot->configuration_size(), 12);
  EXPECT_THAT(robot->zero_configuration(), ElementsAre(0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0.1));

  const RobotJoint& elbow = robot->joints()[1];
  EXPECT_EQ(elbow.type, RobotJoint::Type::kHinge);
  EXPECT_EQ(elbow.body, 3);
  EXPECT_NEAR((elbow.axis - Eigen::Vector3d(std::sqrt(0.5), 0, std::sqrt(0.5))).norm(), 0, 1e-15);
  EXPECT_EQ(elbow.anchor, Eigen::Vector3d(0, -0.05, 0.02));
  EXPECT_EQ(elbow.qpos_address, 8);
  EXPECT_EQ(elbow.dof_address, 7);
  EXPECT_EQ(robot->joints()[3].type, RobotJoint::Type::kSlide);
  EXPECT_EQ(robot->joints()[4].reference, 0.1);
}

TEST(RobotTest, RobotWithoutProfileUsesModelOrderAndRanges) {
  const auto robot = robot_from_text(kTwoArms);
  EXPECT_EQ(robot->name(), "robot");
  EXPECT_THAT(robot->output_joints(), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_EQ(robot->limits_for("gmr"), "model");
  EXPECT_THAT(robot->model_limits().lower, ElementsAre(-1, 0, -kUnlimited, -0.2, -2));
  EXPECT_THAT(robot->model_limits().upper, ElementsAre(1.5, 2.5, kUnlimited, 0.2, 0.5));
  EXPECT_THAT(robot->profile().soles, IsEmpty());
}

TEST(RobotTest, DoesNotFindUnnamedElements) {
  const auto robot = robot_from_text(
      "<mujoco><worldbody><body><freejoint/><geom size='1'/><body><joint/><geom size='1'/></body>"
      "</body></worldbody></mujoco>");
  EXPECT_EQ(robot->find_body(""), std::nullopt);
  EXPECT_EQ(robot->find_joint(""), std::nullopt);
}

TEST(ForwardKinematicsTest, HingeRotatesAboutItsAnchor) {
  const auto robot = robot_from_text(R"(
<mujoco><worldbody><body name="base"><freejoint/><geom size="1"/>
  <body name="arm" pos="1 0 0"><joint axis="0 0 1" pos="0 1 0"/><geom size="1"/></body>
</body></worldbody></mujoco>)");
  // A quarter turn about (1, 1) moves the arm's origin from (1, 0) to (2, 1).
  std::vector<double> qpos = robot->zero_configuration();
  qpos[7] = M_PI / 2;
  const auto poses = own_kinematics(*robot, qpos);
  EXPECT_NEAR((poses[2].translation - Eigen::Vector3d(2, 1, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR((poses[2] * Eigen::Vector3d(0, 1, 0) - Eigen::Vector3d(1, 1, 0)).norm(), 0, 1e-15);
}

TEST(ForwardKinematicsTest, MatchesMujocoOnAnchorsSlidesAndMultiJointBodies) {
  expect_mujoco_agrees(*robot_from_text(kTwoArms), 100);
  expect_mujoco_agrees(*robot_from_text(R"(
<mujoco>
  <compiler angle="degree" eulerseq="zyx"/>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="stand" pos="3 2 1" euler="10 20 30"><geom size="0.1"/></body>
    <body name="base" pos="0.1 0.2 0.3" quat="2 1 0 1">
      <freejoint/>
      <geom size="0.1"/>
      <body name="hand" pos="0.3 -0.2 0.5" euler="30 40 50">
        <joint type="slide" axis="1 2 3" ref="0.2"/>
        <joint axis="0 1 1" pos="0.1 0.2 0.3" ref="20"/>
        <joint axis="1 0 0" pos="-0.1 0.3 0"/>
        <joint type="slide" axis="0 -1 0"/>
        <geom size="0.1"/>
        <body name="tip" pos="0 0 0.2" axisangle="1 1 0 33"/>
      </body>
      <frame pos="0.1 0 0" euler="0 90 0">
        <body name="framed" pos="0 0 1"><joint axis="0 0 1"/><geom size="0.1"/></body>
      </frame>
    </body>
    <body name="post" pos="1 1 1"><geom size="0.1"/></body>
  </worldbody>
</mujoco>)"),
                       100);
}

TEST(ForwardKinematicsTest, MatchesMujocoOnAllReferenceRobots) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  int robots = 0;
  for (const auto& entry : fs::recursive_directory_iterator(*shared / "reference" / "robots")) {
    if (entry.path().extension() != ".xml") continue;
    const auto robot = load_robot_files(entry.path().string());
    if (!robot) continue;  // A part, or the robot on wheels; load_model_test checks the others.
    expect_mujoco_agrees(**robot, 20);
    ++robots;
  }
  EXPECT_GE(robots, 17);
}

TEST(ForwardKinematicsTest, NormalisesTheRootQuaternion) {
  const auto robot = robot_from_text(kTwoArms);
  std::mt19937 random(5);
  std::vector<double> qpos = random_configuration(*robot, random);
  const auto unit = own_kinematics(*robot, qpos);
  for (int i = 3; i < 7; ++i) qpos[i] *= -3.0;
  const auto scaled = own_kinematics(*robot, qpos);
  for (std::size_t b = 0; b < unit.size(); ++b) {
    EXPECT_LT(difference(unit[b], scaled[b]), kPoseTolerance);
  }
}

TEST(RobotTest, CollisionShapesAreTheContactPrimitives) {
  const auto robot = robot_from_text(R"(
<mujoco><worldbody>
  <geom type="box" size="1 1 1"/>
  <body name="table"><geom type="box" size="1 1 1"/></body>
  <body name="base"><freejoint/>
    <geom type="sphere" pos="1 2 3" size="0.1"/>
    <geom type="cylinder" size="0.1 0.2"/>
    <geom type="sphere" size="0.5" contype="0" conaffinity="0"/>
    <body name="arm">
      <geom type="capsule" fromto="0 0 0 2 0 0" size="0.2"/>
      <geom type="box" pos="0 0 1" size="1 2 3"/>
    </body>
  </body></worldbody></mujoco>)");
  const auto& shapes = robot->collision_shapes();
  ASSERT_EQ(shapes.size(), 3U);
  EXPECT_EQ(shapes[0].type, CollisionShape::Type::kSphere);
  EXPECT_EQ(shapes[0].body, *robot->find_body("base"));
  EXPECT_EQ(shapes[0].body_from_shape.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(shapes[0].radius, 0.1);
  EXPECT_EQ(shapes[1].type, CollisionShape::Type::kCapsule);
  EXPECT_EQ(shapes[1].body, *robot->find_body("arm"));
  const Eigen::Vector3d end(0, 0, shapes[1].half_length);
  const Eigen::Vector3d ends =
      (shapes[1].body_from_shape * end).cwiseMax(shapes[1].body_from_shape * -end);
  EXPECT_NEAR((ends - Eigen::Vector3d(2, 0, 0)).norm(), 0, 1e-12);
  EXPECT_EQ(shapes[1].radius, 0.2);
  EXPECT_EQ(shapes[2].type, CollisionShape::Type::kBox);
  EXPECT_EQ(shapes[2].half_size, Eigen::Vector3d(1, 2, 3));
}

TEST(RobotClipTest, FramesAreIndependent) {
  const auto robot = robot_from_text(kTwoArms);
  RobotClip clip(robot, frame_rate_from_fps(30), 3);
  EXPECT_EQ(clip.frame_count(), 3);
  clip.qpos(1)[2] = 5.0;
  const RobotClip& same = clip;
  const auto zero = robot->zero_configuration();
  for (const int frame : {0, 2}) {
    EXPECT_THAT(same.qpos(frame), ::testing::ElementsAreArray(zero));
  }
  EXPECT_EQ(same.qpos(1)[2], 5.0);
  EXPECT_EQ(&clip.robot(), robot.get());
}

}  // namespace
}  // namespace retarget
