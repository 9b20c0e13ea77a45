// With Follow::kArms, only the arm joints of every robot stay free.

#include "app/plan/set_up_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "retarget/load.h"
#include "retarget/load_robot.h"
#include "retarget/plan.h"
#include "retarget/retargeting_config.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

RobotSetup arms_of(const std::string& name, const std::string& variant = {}) {
  RobotChoice choice;
  choice.name = name;
  choice.variant = variant;
  choice.follow = Follow::kArms;
  auto robot = value_of(load_robot(choice, DataFolder{RETARGET_SOURCE_DIR}));
  return value_of(set_up_robot(std::move(robot), Options{}));
}

std::size_t free_joints(const RobotSetup& setup) {
  const Robot& robot = *setup.loaded.robot;
  return robot.output_joints().size() - locked_joints(robot, setup.limits).size();
}

TEST(FollowArms, LegsTrunkAndHeadAreLocked) {
  const std::map<std::string, std::size_t> arms = {
      {"unitree_g1", 14}, {"unitree_g1_with_hands", 28},  {"unitree_h1", 8},
      {"unitree_h2", 14}, {"berkeley_humanoid_lite", 10}, {"booster_t1", 8},
      {"pal_talos", 14}};
  for (const auto& [name, count] : arms) {
    const RobotSetup setup = arms_of(name);
    const Robot& robot = *setup.loaded.robot;
    EXPECT_TRUE(robot.fixed_base()) << name;
    EXPECT_EQ(free_joints(setup), count) << name;
    // Equal on both sides.
    for (const int joint : robot.output_joints()) {
      const auto j = static_cast<std::size_t>(joint);
      EXPECT_LE(setup.limits.lower[j], setup.limits.upper[j]) << name;
    }
  }
  const RobotSetup g1 = arms_of("unitree_g1");
  const auto locked = locked_joints(*g1.loaded.robot, g1.limits);
  EXPECT_THAT(locked, testing::Contains("waist_yaw_joint"));
  EXPECT_THAT(locked, testing::Contains("left_ankle_roll_joint"));
  EXPECT_THAT(locked, testing::Not(testing::Contains("left_shoulder_pitch_joint")));
  EXPECT_THAT(locked, testing::Not(testing::Contains("right_wrist_yaw_joint")));
  // A variant without wrists has two fewer joints in each arm.
  EXPECT_EQ(free_joints(arms_of("unitree_g1", "23")), 10U);
}

TEST(FollowArms, EveryRobotHasArmsThatFollow) {
  int robots = 0;
  for (const auto& entry : fs::directory_iterator(RETARGET_SOURCE_DIR "/robots")) {
    if (!fs::exists(entry.path() / "robot.json")) continue;
    ++robots;
    const std::string name = entry.path().filename().string();
    const RobotSetup setup = arms_of(name);
    const std::size_t count = free_joints(setup);
    EXPECT_GE(count, 8U) << name;
    EXPECT_EQ(count % 2, 0U) << name;
    EXPECT_EQ(setup.config.root_bone, Bone::kSpine2) << name;
    for (const ConfigTask& task : setup.config.match_tables[1].tasks) {
      EXPECT_EQ(task.position_weight, 0.0) << name;
      const bool of_arm = limb_bone(task.bone) == LimbBone::kArm ||
                          limb_bone(task.bone) == LimbBone::kForeArm ||
                          limb_bone(task.bone) == LimbBone::kHand;
      EXPECT_TRUE(of_arm || task.rotation_weight == 0.0) << name << " " << bone_name(task.bone);
    }
  }
  EXPECT_GT(robots, 10);
}

TEST(FollowArms, RejectsARobotWithoutArms) {
  RobotSetup setup = arms_of("unitree_g1");
  setup.config =
      load_config(RETARGET_SOURCE_DIR "/robots/unitree_g1/ik.json", *setup.loaded.robot).value();
  const std::vector<Bone> arms = {Bone::kLeftArm,  Bone::kLeftForeArm,  Bone::kLeftHand,
                                  Bone::kRightArm, Bone::kRightForeArm, Bone::kRightHand};
  ASSERT_TRUE(leave_out_bones(setup.config, arms));
  const auto refused = follow_arms_alone(*setup.loaded.robot, setup);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("no arm of unitree_g1"));
}

RobotChoice g1_with(Follow follow) {
  RobotChoice choice;
  choice.name = "unitree_g1";
  choice.follow = follow;
  return choice;
}

std::string fault_of(const Options& options, Follow follow = Follow::kAll) {
  auto robot = value_of(load_robot(g1_with(follow), DataFolder{RETARGET_SOURCE_DIR}));
  const auto setup = set_up_robot(std::move(robot), options);
  return setup ? std::string() : setup.error().message;
}

TEST(SetUpRobot, ContactsEndAboveTheValuesBelowWhichTheyBegin) {
  Options options;
  options.solve.fit.contact_speed = 0.3;
  EXPECT_THAT(fault_of(options), testing::HasSubstr("\"contact_release_speed\" is 0.25, below"));
  options.solve.fit.contact_release_speed = 0.3;
  EXPECT_EQ(fault_of(options), "");
  options.solve.fit.contact_release_height = 0.03;
  EXPECT_THAT(fault_of(options), testing::HasSubstr("\"contact_release_height\" is 0.03, below"));
}

TEST(SetUpRobot, RejectsTermsThatAreBothOnAndOff) {
  Options options;
  options.solve.with = {"dynamics"};
  options.solve.without = {"floor"};
  EXPECT_EQ(fault_of(options), "");
  options.solve.without = {"floor", "dynamics"};
  EXPECT_THAT(fault_of(options), testing::HasSubstr("both name the term \"dynamics\""));
}

TEST(SetUpRobot, FixedBasesHaveNoSceneToWrite) {
  Options options;
  options.solve.terrain = "slope:5";
  EXPECT_EQ(fault_of(options, Follow::kArms), "");
  options.save.scene_out = "a.json";
  EXPECT_THAT(fault_of(options, Follow::kArms), testing::HasSubstr("has no scene"));
}

}  // namespace
}  // namespace retarget
