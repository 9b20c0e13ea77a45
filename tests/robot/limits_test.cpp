#include "retarget/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Result<LimitSet> limits_of_file(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  return load_limits(*robot_from_text(kTwoArms), folder.write(name, text));
}

std::string limits_message(const std::string& text) {
  const auto limits = limits_of_file("limits.json", text);
  EXPECT_FALSE(limits.has_value()) << text;
  if (limits) return {};
  EXPECT_EQ(limits.error().kind, ErrorKind::kConfig);
  return full_message(limits.error());
}

TEST(LimitsTest, FindsSetsByName) {
  const auto robot = load_g1();
  for (const char* name : {"official", "gmr", "model"}) {
    const auto limits = value_of(load_limits(*robot, name));
    EXPECT_EQ(limits.name, name);
    EXPECT_EQ(limits.lower.size(), 29U);
  }
}

TEST(LimitsTest, UnknownNameSuggestsAndLists) {
  const auto limits = load_limits(*load_g1(), "offical");
  ASSERT_FALSE(limits.has_value());
  EXPECT_EQ(limits.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(limits.error().message,
              AllOf(HasSubstr("unitree_g1"), HasSubstr("did you mean \"official\"?")));
  EXPECT_THAT(limits.error().hint, HasSubstr("model, official, gmr"));
}

TEST(LimitsTest, JsonFileOverridesModelRanges) {
  const auto limits = value_of(
      limits_of_file("limits.json", R"({"left_twist": [-0.5, 0.5], "left_elbow": [1, 1]})"));
  EXPECT_THAT(limits.lower, ElementsAre(-1, 1, -0.5, -0.2, -2));
  EXPECT_THAT(limits.upper, ElementsAre(1.5, 1, 0.5, 0.2, 0.5));
  EXPECT_THAT(limits.name, HasSubstr("limits.json"));
}

TEST(LimitsTest, ReportsAllErrorsOfAJsonFile) {
  const std::string message = limits_message(
      R"({"left_elbw": [0, 1], "left_elbow": [1, 0], "left_twist": [0], "right_slide": "x"})");
  EXPECT_THAT(message, HasSubstr("4 errors in the joint limits"));
  EXPECT_THAT(message, HasSubstr("did you mean \"left_elbow\"?"));
  EXPECT_THAT(message, HasSubstr("lower is above upper in [1,0]"));
  EXPECT_THAT(message, HasSubstr("found [0]"));
  EXPECT_THAT(message, HasSubstr("found \"x\""));
}

TEST(LimitsTest, RejectsNonFiniteNumbers) {
  EXPECT_THAT(limits_message(R"({"left_elbow": [0, 1e999]})"), HasSubstr("1e999"));
  EXPECT_THAT(limits_message(R"({"left_elbow": [0, NaN]})"), HasSubstr("invalid JSON"));
  EXPECT_THAT(limits_message(R"({"left_elbow": [null, 1]})"), HasSubstr("found [null,1]"));
  EXPECT_THAT(limits_message("[]"), HasSubstr("must be an object"));
}

TEST(LimitsTest, RejectsRangesThatLookLikeDegrees) {
  const std::string message = limits_message(
      R"({"left_shoulder": [-90, 80], "left_elbow": [0, 120], "left_twist": [0, 1]})");
  EXPECT_THAT(message, HasSubstr("ranges reach 120 rad, which looks like degrees: "
                                 "\"left_shoulder\", \"left_elbow\"; write them in radians"));
  const auto model = limits_of_file("limits.xml", R"(
<mujoco><compiler angle="radian"/><worldbody>
  <body><joint name="left_elbow" range="-90 90"/><geom size="1"/></body></worldbody></mujoco>)");
  ASSERT_FALSE(model.has_value());
  EXPECT_THAT(model.error().message, HasSubstr("looks like degrees: \"left_elbow\""));
  // Metres of a slide joint, and turns of a joint without a range in the model.
  EXPECT_TRUE(limits_of_file("limits.json", R"({"right_slide": [-20, 20]})").has_value());
  EXPECT_TRUE(limits_of_file("limits.json", R"({"left_twist": [-50, 50]})").has_value());
}

// A wheel may have a range of many turns; most joints of a robot may not.
TEST(LimitsTest, JointsWithoutRangesMayTurnOften) {
  std::string text = "<mujoco><worldbody><body><freejoint/><geom size=\"1\"/>";
  std::string ranges;
  for (int i = 0; i < 8; ++i) {
    text += "<body><joint name=\"j" + std::to_string(i) + "\"/><geom size=\"1\"/></body>";
    ranges += (i > 0 ? ", \"j" : "\"j") + std::to_string(i) + "\": [-90, 90]";
  }
  const auto robot = robot_from_text(text + "</body></worldbody></mujoco>");
  const TemporaryFolder folder;
  const auto wheel = folder.write("wheel.json", R"({"j0": [-1000, 1000], "j1": [-1, 1]})");
  EXPECT_TRUE(load_limits(*robot, wheel).has_value());
  EXPECT_FALSE(load_limits(*robot, folder.write("all.json", "{" + ranges + "}")).has_value());
}

// No free joint is needed, and joints of another hand are ignored.
TEST(LimitsTest, ReadsMjcfByJointNames) {
  const auto limits = value_of(limits_of_file("limits.xml", R"(
<mujoco><compiler angle="radian"/><worldbody>
  <body><joint name="left_elbow" range="-0.25 0.75"/><geom type="mesh" mesh="missing"/>
    <body><joint name="right_slide" type="slide"/><joint name="finger"/></body></body>
</worldbody><asset><mesh name="missing" file="missing.stl"/></asset></mujoco>)"));
  EXPECT_THAT(limits.lower, ElementsAre(-1, -0.25, -kInfinity, -kInfinity, -2));
  EXPECT_THAT(limits.upper, ElementsAre(1.5, 0.75, kInfinity, kInfinity, 0.5));
}

TEST(LimitsTest, RejectsMjcfOfAnotherRobot) {
  const auto limits = limits_of_file(
      "other.xml",
      "<mujoco><worldbody><body><joint name='knee'/><geom size='1'/></body></worldbody></mujoco>");
  ASSERT_FALSE(limits.has_value());
  EXPECT_THAT(limits.error().message, HasSubstr("none of the joints in robot"));
  EXPECT_THAT(limits.error().hint, HasSubstr("knee"));
}

TEST(LimitsTest, MissingFilesAreErrors) {
  const auto robot = robot_from_text(kTwoArms);
  for (const char* file : {"none.json", "none.xml"}) {
    const auto limits = load_limits(*robot, file);
    ASSERT_FALSE(limits.has_value());
    EXPECT_EQ(limits.error().kind, ErrorKind::kConfig);
    EXPECT_EQ(limits.error().location.file, file);
  }
}

}  // namespace
}  // namespace retarget
