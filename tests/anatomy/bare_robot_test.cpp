#include "robot/anatomy/bare_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "retarget/load_robot.h"
#include "support/humanoids.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

std::string g1_model() {
  return (std::filesystem::path(RETARGET_SOURCE_DIR) / "robots/unitree_g1/model.xml").string();
}

// World corners of a sole at the zero configuration: lowest z, and x from heel to toe.
struct SoleExtent {
  double lowest = INFINITY, heel = INFINITY, toe = -INFINITY;
};

SoleExtent extent_of(const Robot& robot, const Sole& sole) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, robot.zero_configuration(), world_from_body);
  SoleExtent extent;
  for (const Eigen::Vector3d& point : sole.points) {
    const Eigen::Vector3d at = world_from_body[static_cast<std::size_t>(sole.body)] * point;
    extent.lowest = std::min(extent.lowest, at.z());
    extent.heel = std::min(extent.heel, at.x());
    extent.toe = std::max(extent.toe, at.x());
  }
  return extent;
}

TEST(BareRobot, KeepsSolesOfTheProfile) {
  const auto bare = value_of(load_robot_files(g1_model()));
  ASSERT_TRUE(bare->profile().soles.empty());
  const auto completed = value_of(complete_bare_robot(*bare, g1_model()));
  EXPECT_FALSE(completed.guessed);
  const auto known = load_g1();
  ASSERT_EQ(completed.robot->profile().soles.size(), 2U);
  for (std::size_t side = 0; side < 2; ++side) {
    const Sole &found = completed.robot->profile().soles[side],
               &wanted = known->profile().soles[side];
    EXPECT_EQ(found.side, wanted.side);
    EXPECT_EQ(found.body, wanted.body);
    const SoleExtent a = extent_of(*known, found), b = extent_of(*known, wanted);
    EXPECT_NEAR(a.lowest, b.lowest, 1e-3);
    EXPECT_NEAR(a.heel, b.heel, 0.01);
    EXPECT_NEAR(a.toe, b.toe, 0.01);
  }
}

TEST(BareRobot, KeepsEverythingElse) {
  const auto bare = value_of(load_robot_files(g1_model()));
  const auto completed = value_of(complete_bare_robot(*bare, g1_model()));
  const Robot& robot = *completed.robot;
  EXPECT_EQ(robot.name(), bare->name());
  EXPECT_EQ(robot.joint_names(), bare->joint_names());
  EXPECT_EQ(robot.output_joints(), bare->output_joints());
  EXPECT_EQ(robot.zero_configuration(), bare->zero_configuration());
  EXPECT_EQ(robot.model_limits().lower, bare->model_limits().lower);
  EXPECT_EQ(robot.collision_shapes().size(), bare->collision_shapes().size());
  EXPECT_FALSE(robot.profile().allowed_self_contact.empty());
}

// A model with masses but without meshes: soles must be guessed, which is better than none; guessed
// shapes would distort metrics.
TEST(BareRobot, GuessesSolesWithoutShapes) {
  const TemporaryFolder folder;
  std::string text = tiny_humanoid(true);
  for (std::size_t at = text.find("<geom"); at != std::string::npos; at = text.find("<geom", at)) {
    text.insert(at + 5, " contype=\"0\" conaffinity=\"0\"");
    at += 5;
  }
  const std::string model = folder.write("robot.xml", text);
  const auto bare = value_of(load_robot_files(model));
  ASSERT_TRUE(bare->collision_shapes().empty());
  const auto completed = value_of(complete_bare_robot(*bare, model));
  EXPECT_TRUE(completed.guessed);
  EXPECT_EQ(completed.robot->profile().soles.size(), 2U);
  EXPECT_TRUE(completed.robot->collision_shapes().empty());
  // thighs, shins, feet, upper arms, forearms
  EXPECT_EQ(completed.shapeless, 10);
}

// The model defines the shapes that motions are measured with: a capsule instead of a cylinder
// would be a guess.
TEST(BareRobot, KeepsShapesOfTheModel) {
  const TemporaryFolder folder;
  std::string text = tiny_humanoid(true);
  const auto add_geom = [&](const std::string& body, const std::string& geom) {
    const std::size_t at = text.find("<body name=\"" + body + "\"");
    text.insert(text.find('>', at) + 1, geom);
  };
  add_geom("left_shin", "<geom type=\"cylinder\" pos=\"0 0 -0.12\" size=\"0.03 0.1\"/>");
  add_geom("right_shin", "<geom type=\"capsule\" pos=\"0 0 -0.12\" size=\"0.03 0.1\"/>");
  const std::string model = folder.write("robot.xml", text);
  const auto bare = value_of(load_robot_files(model));
  const auto completed = value_of(complete_bare_robot(*bare, model));
  EXPECT_FALSE(completed.guessed);
  const auto &shapes = completed.robot->collision_shapes(), &own = bare->collision_shapes();
  ASSERT_EQ(shapes.size(), own.size());
  for (std::size_t i = 0; i < own.size(); ++i) EXPECT_EQ(shapes[i].geom, own[i].geom);
  // thighs, one shin, upper arms, forearms
  EXPECT_EQ(completed.shapeless, 7);
}

// Feet are not rectangles: a corner beyond the spheres of a narrow heel would touch first.
TEST(BareRobot, SolesMatchTheFootContacts) {
  const TemporaryFolder folder;
  std::string text = tiny_humanoid(true);
  const std::string box = "<geom type=\"box\" pos=\"0.03 0 -0.04\" size=\"0.08 0.03 0.01\"/>";
  for (std::size_t at = text.find(box); at != std::string::npos; at = text.find(box)) {
    text.replace(
        at, box.size(),
        "<geom size=\".01\" pos=\"-.05 .01 -.04\"/><geom size=\".01\" pos=\"-.05 -.01 -.04\"/>"
        "<geom size=\".01\" pos=\".1 .04 -.04\"/><geom size=\".01\" pos=\".1 -.04 -.04\"/>");
  }
  const std::string model = folder.write("robot.xml", text);
  const auto bare = value_of(load_robot_files(model));
  const auto completed = value_of(complete_bare_robot(*bare, model));
  const Eigen::Vector3d wanted[] = {
      {-0.05, 0.01, -0.05}, {-0.05, -0.01, -0.05}, {0.1, 0.04, -0.05}, {0.1, -0.04, -0.05}};
  for (const Sole& sole : completed.robot->profile().soles) {
    ASSERT_EQ(sole.points.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((sole.points[i] - wanted[i]).norm(), 1e-9) << i;
  }
}

TEST(BareRobot, RejectsNonHumanoids) {
  const auto arms = robot_from_text(kTwoArms);
  const auto completed = complete_bare_robot(*arms, "arms.xml");
  ASSERT_FALSE(completed);
  EXPECT_EQ(completed.error().kind, ErrorKind::kConfig);
  EXPECT_EQ(completed.error().location.file, "arms.xml");
}

}  // namespace
}  // namespace retarget
