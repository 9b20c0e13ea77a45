// Variants: joints held and left out of the columns.

#include "robot/variant.h"

#include <gmock/gmock.h>

#include "retarget/motion.h"
#include "robot/limit_distance.h"
#include "shipped_robots.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kProfile = R"({
  "name": "two_arms",
  "limit_sets": {"narrow": {"ranges": {"right_shoulder": [0.2, 0.4]}}},
  "variants": {"one_arm": {"locked": {"right_slide": 0.05, "right_shoulder": -0.3}}}})";

std::shared_ptr<const Robot> two_arms(const std::string& profile = kProfile) {
  const TemporaryFolder folder;
  const auto robot =
      load_robot_files(folder.write("robot.xml", kTwoArms), folder.write("robot.json", profile));
  EXPECT_TRUE(robot) << describe(robot.error());
  return *robot;
}

std::vector<std::string> columns_of(const Robot& robot) {
  std::vector<std::string> names;
  for (const int joint : robot.output_joints()) names.push_back(robot.joints()[joint].name);
  return names;
}

TEST(RobotVariantTest, HeldJointsLeaveColumnsAndLimitSets) {
  const auto whole = two_arms();
  const auto variant = robot_variant(whole, "one_arm");
  ASSERT_TRUE(variant) << describe(variant.error());
  const Robot& robot = **variant;
  EXPECT_EQ(robot.variant().name, "one_arm");
  EXPECT_EQ(robot.name(), "two_arms");
  EXPECT_THAT(columns_of(robot), ElementsAre("left_shoulder", "left_elbow", "left_twist"));
  EXPECT_THAT(robot.zero_configuration(), ElementsAre(0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0.05, -0.3));
  const TemporaryFolder folder;
  const std::string file = folder.write("file.json", R"({"right_slide": [0, 0.1]})");
  for (const std::string& set : {std::string("model"), std::string("narrow"), file}) {
    const auto limits = load_limits(robot, set);
    ASSERT_TRUE(limits) << describe(limits.error());
    EXPECT_EQ(limits->lower[3], 0.05) << set;
    EXPECT_EQ(limits->upper[3], 0.05) << set;
    EXPECT_EQ(limits->lower[4], -0.3) << set;
    EXPECT_EQ(limits->upper[4], -0.3) << set;
    EXPECT_EQ(limits->upper[0], 1.5) << set;
  }
  // the whole robot stays as it was
  EXPECT_EQ(whole->output_joints().size(), 5U);
  EXPECT_EQ(whole->model_limits().lower[4], -2.0);
  EXPECT_EQ(whole->zero_configuration()[11], 0.1);
}

TEST(RobotVariantTest, FullJointCountIsTheWholeRobot) {
  const auto whole = two_arms();
  EXPECT_EQ(robot_variant(whole, "5").value(), whole);
}

TEST(RobotVariantTest, UnknownNamesSuggestAndList) {
  const auto variant = robot_variant(two_arms(), "one_arn");
  ASSERT_FALSE(variant);
  EXPECT_EQ(variant.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(variant.error().message,
              AllOf(HasSubstr("two_arms"), HasSubstr("did you mean \"one_arm\"?")));
  EXPECT_THAT(variant.error().hint, HasSubstr("5, one_arm"));
  const auto without = robot_variant(two_arms(R"({"name": "two_arms"})"), "4");
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error().hint, HasSubstr("its 5 joints"));
}

TEST(RobotVariantTest, HeldJointsAreNotAtALimit) {
  const auto variant = robot_variant(two_arms(), "one_arm").value();
  RobotClip clip(variant, {30, 1}, 2);
  clip.qpos(1)[8] = 2.4;
  const auto nearest = nearest_limit(clip, variant->model_limits());
  ASSERT_TRUE(nearest);
  EXPECT_EQ(nearest->joint, "left_elbow");
}

TEST(RobotVariantTest, G1VariantsMatchPublishedOnes) {
  const auto g1 = load_shipped("unitree_g1");
  const auto all = columns_of(*g1);
  const auto without = [&](const std::vector<int>& columns) {
    std::vector<std::string> names;
    for (int c = 0; c < 29; ++c) {
      if (std::ranges::find(columns, c) == columns.end()) names.push_back(all[c]);
    }
    return names;
  };
  // by columns: 13, 14 waist roll and pitch; 19 to 21 and 26 to 28 the wrists
  const std::map<std::string, std::vector<int>> variants = {{"29", {}},
                                                            {"27", {13, 14}},
                                                            {"23", {13, 14, 20, 21, 27, 28}},
                                                            {"23-pbhc", {19, 20, 21, 26, 27, 28}}};
  for (const auto& [name, held] : variants) {
    const auto variant = robot_variant(g1, name);
    ASSERT_TRUE(variant) << describe(variant.error());
    EXPECT_EQ(columns_of(**variant), without(held)) << name;
    for (const int joint : held) {
      EXPECT_EQ((*variant)->model_limits().lower[joint], 0.0);
      EXPECT_EQ((*variant)->model_limits().upper[joint], 0.0);
    }
  }
  const auto message = robot_variant(g1, "23-pbch").error().message;
  EXPECT_THAT(message, HasSubstr("\"23-pbhc\"?"));
}

TEST(RobotVariantTest, CanOmitHands) {
  const auto variant = robot_variant(load_shipped("unitree_g1_with_hands"), "29");
  ASSERT_TRUE(variant);
  EXPECT_EQ(columns_of(**variant), columns_of(*load_shipped("unitree_g1")));
}

}  // namespace
}  // namespace retarget
