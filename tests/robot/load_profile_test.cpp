// Profiles: the properties that they add to a robot, and their error messages.

#include "robot/model/load_profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "retarget/load_robot.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;

Result<std::shared_ptr<const Robot>> load(const std::string& profile) {
  const TemporaryFolder folder;
  return load_robot_files(folder.write("robot.xml", kTwoArms), folder.write("robot.json", profile));
}

std::string profile_message(const std::string& profile) {
  const auto robot = load(profile);
  EXPECT_FALSE(robot.has_value()) << profile;
  if (robot) return {};
  EXPECT_EQ(robot.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(robot.error().location.file, HasSubstr("robot.json"));
  return full_message(robot.error());
}

// A profile with one additional member.
std::string message_with(const std::string& member) {
  return profile_message("{\"name\": \"two_arms\", " + member + "}");
}

TEST(LoadProfileTest, ReadsEveryPart) {
  const auto loaded = value_of(load(R"({
    "name": "two_arms", "description": "d", "source": "s", "licence": "l",
    "joint_order": ["right_slide", "left_elbow"],
    "limit_sets": {"narrow": {"source": "a sheet", "ranges": {"left_elbow": [0.5, 1]}}},
    "default_limits": "narrow",
    "method_limits": {"gmr": "model"},
    "speed_limits": {"left_elbow": 7.5},
    "speed_limits_source": "a sheet",
    "revision": "v2, 0123abc",
    "revision_date": "2026-01-02",
    "soles_source": "a ruler",
    "soles_estimated": true,
    "default_speed_limit": 12,
    "coupled_joints": {"left_elbow": {"joint": "left_shoulder", "ratio": -0.5, "offset": 0.1},
                       "left_twist": {"joint": "left_shoulder"}},
    "t_pose": {"left_shoulder": 1.25},
    "variants": {"one_arm": {"description": "v", "locked": {"right_slide": 0.1}}},
    "soles": {"left": {"body": "left_lower", "points": [[1, 2, 3], [4, 5, 6]],
                       "labels": ["heel", "toe"]}},
    "allowed_self_contact": [["base", "left_lower"]]})"));
  const Robot& robot = *loaded;
  EXPECT_EQ(robot.name(), "two_arms");
  EXPECT_EQ(robot.profile().licence, "l");
  EXPECT_THAT(robot.output_joints(), ElementsAre(3, 1));
  ASSERT_EQ(robot.profile().limit_sets.size(), 1U);
  const LimitSet& narrow = robot.profile().limit_sets[0];
  EXPECT_EQ(narrow.source, "a sheet");
  EXPECT_EQ(narrow.lower[1], 0.5);
  EXPECT_EQ(narrow.upper[1], 1.0);
  EXPECT_EQ(narrow.lower[0], -1.0);  // Not in the file: the model's range.
  EXPECT_EQ(robot.limits_for("gmr"), "model");
  EXPECT_EQ(robot.limits_for("fit"), "narrow");
  EXPECT_THAT(robot.profile().speed_limits, ElementsAre(Pair("left_elbow", 7.5)));
  EXPECT_EQ(robot.profile().speed_limits_source, "a sheet");
  EXPECT_EQ(robot.profile().revision, "v2, 0123abc");
  EXPECT_EQ(robot.profile().revision_date, "2026-01-02");
  EXPECT_EQ(robot.profile().soles_source, "a ruler");
  EXPECT_TRUE(robot.profile().soles_estimated);
  EXPECT_EQ(robot.speed_limit(0), 12.0);
  EXPECT_EQ(robot.speed_limit(1), 7.5);
  EXPECT_EQ(robot.speed_limit(3), kDefaultSlideSpeedLimit);
  ASSERT_EQ(robot.profile().coupled_joints.size(), 2U);
  const JointCoupling& coupling = robot.profile().coupled_joints.at("left_elbow");
  EXPECT_EQ(coupling.leader, "left_shoulder");
  EXPECT_EQ(coupling.ratio, -0.5);
  EXPECT_EQ(coupling.offset, 0.1);
  EXPECT_EQ(robot.profile().coupled_joints.at("left_twist").ratio, 1.0);
  EXPECT_THAT(robot.profile().t_pose, ElementsAre(Pair("left_shoulder", 1.25)));
  ASSERT_EQ(robot.profile().variants.size(), 1U);
  EXPECT_EQ(robot.profile().variants[0].name, "one_arm");
  EXPECT_EQ(robot.profile().variants[0].description, "v");
  EXPECT_THAT(robot.profile().variants[0].locked, ElementsAre(Pair("right_slide", 0.1)));
  ASSERT_EQ(robot.profile().soles.size(), 1U);
  const Sole& sole = robot.profile().soles[0];
  EXPECT_EQ(sole.side, "left");
  EXPECT_EQ(sole.body, 3);
  EXPECT_THAT(sole.points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
  EXPECT_THAT(sole.labels, ElementsAre("heel", "toe"));
  EXPECT_THAT(robot.profile().allowed_self_contact, ElementsAre(Pair(1, 3)));
}

TEST(LoadProfileTest, OnlyNameIsRequired) {
  const auto robot = value_of(load(R"({"name": "two_arms"})"));
  EXPECT_EQ(robot->output_joints().size(), 5U);
  EXPECT_EQ(robot->limits_for("gmr"), "model");
  EXPECT_EQ(robot->speed_limit(0), 20.0);
}

TEST(LoadProfileTest, SyntaxErrorsHaveLineAndColumn) {
  const auto robot = load("{\"name\": \"x\",\n \"soles\": }");
  ASSERT_FALSE(robot.has_value());
  EXPECT_EQ(robot.error().location.line, 2U);
  EXPECT_EQ(robot.error().location.column, 11U);
}

TEST(LoadProfileTest, NameMustBeAValidFolderName) {
  for (const char* name : {"..", ".", "a/b", "../x", "/etc", "a\\\\b", "a\\u0000b", "\\u001b[2J"}) {
    EXPECT_THAT(profile_message("{\"name\": \"" + std::string(name) + "\"}"),
                HasSubstr("\"name\" must be a valid folder name"))
        << name;
  }
}

TEST(LoadProfileTest, ReportsAllErrors) {
  const std::string message = profile_message(R"({
    "joint_ordr": [],
    "joint_order": ["left_elbo", "left_elbow", "left_elbow"],
    "limit_sets": {"a": {"ranges": {"left_elbow": [2, 1], "knee": [0, 1]}}},
    "default_limits": "b",
    "speed_limits": {"right_slid": 1, "left_elbow": -1},
    "soles": {"left": {"body": "left_lowr", "points": [[0, 0, 0]]}},
    "allowed_self_contact": [["base", "elbow"]]})");
  EXPECT_THAT(message, HasSubstr("11 errors in the robot profile"));
  EXPECT_THAT(message, HasSubstr("\"name\" is missing"));
  EXPECT_THAT(message, HasSubstr("\"joint_ordr\" (did you mean \"joint_order\"?)"));
  EXPECT_THAT(message, HasSubstr("\"left_elbo\" (did you mean \"left_elbow\"?)"));
  EXPECT_THAT(message, HasSubstr("names \"left_elbow\" twice"));
  EXPECT_THAT(message, HasSubstr("lower is above upper"));
  EXPECT_THAT(message, HasSubstr("no joint \"knee\""));
  EXPECT_THAT(message, HasSubstr("no limit set \"b\""));
  EXPECT_THAT(message, HasSubstr("\"right_slid\" (did you mean \"right_slide\"?)"));
  EXPECT_THAT(message, HasSubstr("above 0, found -1"));
  EXPECT_THAT(message, HasSubstr("\"left_lowr\" (did you mean \"left_lower\"?)"));
  EXPECT_THAT(message, HasSubstr("no body \"elbow\""));
}

TEST(LoadProfileTest, ReportsErrorsOfEachKind) {
  EXPECT_THAT(message_with(R"("default_speed_limit": 0)"), HasSubstr("above 0, found 0"));
  EXPECT_THAT(message_with(R"("t_pose": {"left_elbw": 0})"), HasSubstr("\"left_elbow\"?"));
  EXPECT_THAT(message_with(R"("t_pose": {"left_elbow": "up"})"), HasSubstr("must be a number"));
  EXPECT_THAT(message_with(R"("variants": {"a": {"locked": {}}})"), HasSubstr("variant \"a\""));
  EXPECT_THAT(message_with(R"("variants": {"a": {"locked": {"left_elbw": 0}}})"),
              AllOf(HasSubstr("variant \"a\""), HasSubstr("\"left_elbow\"?")));
  EXPECT_THAT(
      message_with(R"("variants": {"a": {"locked": {"left_elbow": 0}, "model": "../a.xml"}})"),
      HasSubstr("must be a file in the profile's folder, found \"../a.xml\""));
  EXPECT_THAT(
      message_with(R"("variants": {"a": {"locked": {"left_elbow": 0}, "bodies": ["left_uper"]}})"),
      HasSubstr("the model has no body \"left_uper\""));
  EXPECT_THAT(message_with(R"("variants": {"a": {"locked": {"left_elbow": 0},
                                                 "anchors": {"right_slide": [0, 0, 0]}}})"),
              HasSubstr("\"anchors\" requires the variant to have its own \"model\""));
  EXPECT_THAT(message_with(R"("variants": {"a": {"locked": {"left_elbow": 0}, "model": "a.xml",
                                                 "anchors": {"right_slide": [0, 0]}}})"),
              HasSubstr("the anchor of \"right_slide\" must be [x, y, z]"));
  EXPECT_THAT(message_with(R"("joint_frames": ["left_lowr"])"), HasSubstr("\"left_lower\"?"));
  EXPECT_THAT(message_with(R"("joint_frames": ["base"])"), HasSubstr("must contain one body"));
  EXPECT_THAT(message_with(R"("variants": {"a": {"loked": {}, "locked": {"left_elbow": 0}}})"),
              HasSubstr("did you mean \"locked\"?"));
  EXPECT_THAT(message_with(R"("variants": {"": {"locked": {"left_elbow": 0}}})"),
              HasSubstr("has no name"));
  EXPECT_THAT(message_with(R"("joint_order": [])"), HasSubstr("\"joint_order\" is empty"));
  EXPECT_THAT(message_with(R"("limit_sets": {"model": {"ranges": {}}})"), HasSubstr("reserved"));
  EXPECT_THAT(message_with(R"("limit_sets": {"a": {"rangs": {}, "ranges": {}}})"),
              AllOf(HasSubstr("\"a\""), HasSubstr("did you mean \"ranges\"?")));
  EXPECT_THAT(message_with(R"("method_limits": {"gmr": "gmr"})"), HasSubstr("no limit set"));
  EXPECT_THAT(message_with(R"("soles": {"lefft": {"body": "base", "points": [[0, 0, 0]]}})"),
              HasSubstr("did you mean \"left\"?"));
  EXPECT_THAT(message_with(R"("soles": {"left": {"body": "base", "points": []}})"),
              HasSubstr("no points"));
  EXPECT_THAT(
      message_with(R"("soles": {"left": {"body": "base", "points": [[0, 0]], "labels": ["a"]}})"),
      HasSubstr("must be [x, y, z], found [0,0]"));
  EXPECT_THAT(
      message_with(R"("soles": {"left": {"body": "base", "points": [[0, 0, 0]], "labels": []}})"),
      HasSubstr("1 points but 0 labels"));
}

TEST(LoadProfileTest, RejectsUnknownMethodsAndMalformedDates) {
  EXPECT_THAT(message_with(R"("method_limits": {"GMR": "model"})"),
              HasSubstr("no method \"GMR\"; the methods are fit, gmr"));
  for (const char* date : {"yesterday", "2026-13-01", "2026-02-30", "2026-1-2", "26-01-02",
                           "2026-01-02T00:00", "+026-01-02"}) {
    EXPECT_THAT(message_with("\"revision_date\": \"" + std::string(date) + "\""),
                AllOf(HasSubstr("must be a date YYYY-MM-DD"), HasSubstr(date)));
  }
}

TEST(LoadProfileTest, RejectsPositionsAndRangesInDegrees) {
  EXPECT_THAT(message_with(R"("t_pose": {"left_shoulder": 90})"),
              AllOf(HasSubstr("\"t_pose\" of \"left_shoulder\" is 90 rad"),
                    HasSubstr("looks like degrees")));
  EXPECT_THAT(message_with(R"("variants": {"a": {"locked": {"left_elbow": -45}}})"),
              HasSubstr("looks like degrees"));
  EXPECT_THAT(message_with(R"("limit_sets": {"a": {"ranges": {"left_elbow": [-90, 90]}}})"),
              HasSubstr("limit set \"a\": ranges reach 90 rad, which looks like degrees: "
                        "\"left_elbow\"; write them in radians"));
  // A slide joint has metres.
  EXPECT_TRUE(load(R"({"name": "n", "t_pose": {"right_slide": 90}})").has_value());
}

TEST(LoadProfileTest, CouplingsNameJointsAndNumbers) {
  const auto of = [](const std::string& coupling) {
    return message_with("\"coupled_joints\": {\"left_elbow\": " + coupling + "}");
  };
  EXPECT_THAT(of(R"({"joint": "left_shouder"})"), HasSubstr("did you mean \"left_shoulder\""));
  EXPECT_THAT(of(R"({"joint": "left_elbow"})"), HasSubstr("cannot be coupled to itself"));
  EXPECT_THAT(of(R"({"joint": "left_shoulder", "ratio": "2"})"), HasSubstr("must be a number"));
  EXPECT_THAT(of(R"({"joint": "left_shoulder", "ratoi": 2})"), HasSubstr("ratoi"));
  EXPECT_THAT(of("2"), HasSubstr("must be {"));
  const std::string cycle = message_with(R"("coupled_joints": {
      "left_twist": {"joint": "left_shoulder"}, "left_shoulder": {"joint": "left_elbow"},
      "left_elbow": {"joint": "left_twist"}, "right_slide": {"joint": "left_twist"}})");
  EXPECT_THAT(cycle, HasSubstr("drive each other in a cycle: \"left_elbow\", \"left_twist\", "
                               "\"left_shoulder\""));
  EXPECT_THAT(cycle, Not(HasSubstr("right_slide")));
  EXPECT_THAT(message_with(R"("coupled_joints": {"elbow": {"joint": "left_elbow"}})"),
              HasSubstr("no joint \"elbow\""));
}

// Every member with every type, at two depths: an error or a robot, never an exception.
TEST(LoadProfileTest, RejectsWrongTypes) {
  const std::vector<std::string> values = {"null",
                                           "true",
                                           "1",
                                           "\"x\"",
                                           "[]",
                                           "{}",
                                           "[[1]]",
                                           "{\"x\": 1}",
                                           "{\"left\": {\"body\": 1, \"points\": 1}}",
                                           "{\"a\": {\"ranges\": 1, \"source\": 1}}",
                                           "{\"left\": {\"body\": \"base\", \"points\": [1], "
                                           "\"labels\": \"x\"}}"};
  for (const char* key :
       {"name", "description", "revision", "revision_date", "joint_order", "limit_sets",
        "default_limits", "method_limits", "speed_limits", "speed_limits_source", "coupled_joints",
        "t_pose", "soles", "soles_source", "soles_estimated", "allowed_self_contact",
        "joint_frames", "variants"}) {
    for (const std::string& value : values) {
      const auto robot = load("{\"name\": \"n\", \"" + std::string(key) + "\": " + value + "}");
      if (!robot) {
        EXPECT_EQ(robot.error().kind, ErrorKind::kConfig);
        EXPECT_THAT(robot.error().message, Not(HasSubstr("exception")));
      }
    }
    EXPECT_FALSE(load("{\"name\": \"n\", \"" + std::string(key) + "\": 1}").has_value()) << key;
    EXPECT_FALSE(load("{\"name\": \"n\", \"" + std::string(key) + "\": null}").has_value()) << key;
  }
  for (const std::string& value : values) profile_message(value);
}

TEST(LoadProfileTest, MissingFileIsAnError) {
  const TemporaryFolder folder;
  const auto robot = load_robot_files(folder.write("robot.xml", kTwoArms), "no/robot.json");
  ASSERT_FALSE(robot.has_value());
  EXPECT_EQ(robot.error().location.file, "no/robot.json");
}

}  // namespace
}  // namespace retarget
