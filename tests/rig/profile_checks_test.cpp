// robots check for faults of a robot's profile, and robots with faults in lists.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/rig.h"
#include "rig/finding_texts.h"
#include "support/humanoids.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

using Profile = nlohmann::ordered_json;
using Change = std::function<void(Profile&)>;

// A robot of `robots add` whose profile is then edited.
class ProfileChecksTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto made = value_of(make_robot(folder_.write("any.xml", tiny_humanoid(true)), "mine"));
    std::filesystem::create_directory(folder_.path() / "mine");
    folder_.write("mine/model.xml", made.model);
    config_ = folder_.write("mine/ik.json", made.config);
    profile_ = made.profile;
    write(profile_);
  }

  void write(const std::string& profile) { folder_.write("mine/robot.json", profile); }
  void edit(const Change& change) {
    Profile profile = Profile::parse(profile_);
    change(profile);
    write(profile.dump());
  }
  [[nodiscard]] std::string robot() const { return (folder_.path() / "mine").string(); }

  std::vector<std::string> findings(bool faults) {
    return finding_texts(check_robot(find_robot_sources(robot(), RETARGET_SOURCE_DIR).value()),
                         faults);
  }
  [[nodiscard]] Result<LoadedRobot> loaded() const {
    RobotChoice choice;
    choice.name = robot();
    return load_robot(choice, {RETARGET_SOURCE_DIR});
  }
  std::vector<std::string> warnings() {
    std::vector<std::string> texts;
    const auto robot = value_of(loaded());
    for (const Warning& warning : robot.warnings) texts.push_back(warning.message);
    return texts;
  }
  void expect_misplaced(const Change& change, const std::string& what) {
    edit(change);
    EXPECT_THAT(findings(true), Contains(HasSubstr(what)));
    EXPECT_THAT(warnings(), Contains(HasSubstr(what)));
  }

  TemporaryFolder folder_;
  std::string config_, profile_;
};

TEST_F(ProfileChecksTest, AcceptsAnAddedRobot) {
  EXPECT_THAT(findings(true), IsEmpty());
  EXPECT_THAT(warnings(), IsEmpty());
}

TEST_F(ProfileChecksTest, BothFeetNeedASole) {
  edit([](Profile& profile) { profile["soles"].erase("right"); });
  EXPECT_THAT(findings(true), ElementsAre(AllOf(HasSubstr("only the left foot has a sole"),
                                                HasSubstr("add \"right\""))));
  const auto refused = loaded();
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(refused.error().location.file, HasSubstr("robot.json"));
  EXPECT_THAT(refused.error().message, HasSubstr("only the left foot has a sole"));
  // Without soles, both are found in the model.
  edit([](Profile& profile) { profile.erase("soles"); });
  EXPECT_THAT(findings(true), IsEmpty());
  EXPECT_EQ(loaded().value().robot->profile().soles.size(), 2U);
}

TEST_F(ProfileChecksTest, SolesAreAtTheFeetOfTheirSides) {
  const std::string other = "the left sole is on \"right_foot\", which is in the right leg";
  expect_misplaced([](Profile& p) { std::swap(p["soles"]["left"], p["soles"]["right"]); }, other);
  expect_misplaced([](Profile& p) { p["soles"]["left"] = p["soles"]["right"]; }, other);
  expect_misplaced([](Profile& p) { p["soles"]["left"]["body"] = "torso"; },
                   "the left sole is on \"torso\", which is not in a leg");
  expect_misplaced([](Profile& p) { p["soles"]["left"]["body"] = "left_thigh"; },
                   "points of the left sole are up to");
  for (const double unit : {100.0, 1000.0}) {
    expect_misplaced(
        [&](Profile& profile) {
          for (Profile& point : profile["soles"]["left"]["points"]) {
            for (Profile& value : point) value = unit * value.get<double>();
          }
        },
        "points of the left sole are up to");
  }
}

TEST_F(ProfileChecksTest, LimitSetsThatContradictTheModelAreNoted) {
  edit([](Profile& profile) {
    profile["limit_sets"] = {{"odd", {{"ranges", {{"left_knee", {3, 4}}}}}},
                             {"wide", {{"ranges", {{"left_knee", {-3, 3}}}}}},
                             {"close", {{"ranges", {{"left_knee", {-1, 3}}}}}}};
  });
  EXPECT_THAT(findings(true), IsEmpty());
  EXPECT_THAT(findings(false),
              Contains(HasSubstr("limit set odd has no position in common with "
                                 "the model on 1 joint, most on left_knee (0.6 rad)")));
  EXPECT_THAT(findings(false),
              Contains(HasSubstr("limit set wide is much wider than the model on 1 joint,")));
  EXPECT_THAT(findings(false), Each(Not(HasSubstr("limit set close"))));
}

TEST_F(ProfileChecksTest, PositionsOutsideTheRangesAreReported) {
  edit([](Profile& profile) {
    profile["t_pose"]["left_knee"] = 3;
    profile["variants"] = {{"stiff", {{"locked", {{"right_knee", 4}, {"left_hip_yaw", 0.5}}}}}};
  });
  EXPECT_THAT(findings(true),
              ElementsAre("variant \"stiff\" locks \"right_knee\" at 4, outside its range from 0 "
                          "to 2.4"));
  EXPECT_THAT(findings(false), Contains(HasSubstr("has \"left_knee\" at 3, outside its range")));
}

TEST_F(ProfileChecksTest, PositionsAreComparedWithTheNearestRange) {
  edit([](Profile& profile) {
    profile["limit_sets"] = {
        {"wide", {{"ranges", {{"left_knee", {-1, 3}}, {"right_knee", {0, 2}}}}}}};
    profile["variants"] = {{"bent", {{"locked", {{"left_knee", 2.9}}}}},
                           {"stiff", {{"locked", {{"left_knee", 4}}}}},
                           {"tight", {{"locked", {{"right_knee", 4}}}}}};
  });
  EXPECT_THAT(
      findings(true),
      ElementsAre("variant \"stiff\" locks \"left_knee\" at 4, outside its range from -1 to 3 in "
                  "limit set wide",
                  "variant \"tight\" locks \"right_knee\" at 4, outside its range from 0 to 2.4"));
}

TEST_F(ProfileChecksTest, DifferencesOfSlidesAreInMetres) {
  const std::string file = (folder_.path() / "mine" / "model.xml").string();
  std::string model(read_file(file, ErrorKind::kConfig).value().view());
  const std::string hinge = "type=\"hinge\"";
  const std::size_t type = model.find(hinge, model.find("<joint name=\"left_knee\""));
  ASSERT_NE(type, std::string::npos);
  folder_.write("mine/model.xml", model.replace(type, hinge.size(), "type=\"slide\""));
  edit([](Profile& profile) {
    profile["limit_sets"] = {{"odd", {{"ranges", {{"left_knee", {3, 4}}}}}}};
  });
  EXPECT_THAT(findings(false),
              AllOf(Contains(AllOf(HasSubstr("has no position in common with the model"),
                                   HasSubstr("on 1 joint, most on left_knee"), HasSubstr(" m)"))),
                    Contains("no speed limit for any joint: 20 rad/s (slides: 1 m/s) is used")));
}

TEST_F(ProfileChecksTest, CouplingsOutsideOfHandsAreNoted) {
  edit([](Profile& profile) {
    profile["coupled_joints"] = {{"left_knee", {{"joint", "right_knee"}}}};
  });
  EXPECT_THAT(findings(false), Contains("a joint coupling is dropped, both joints move freely: "
                                        "\"left_knee\" to \"right_knee\""));
}

// Nothing is concluded from a file that cannot be read.
TEST_F(ProfileChecksTest, ErrorsOfFilesAreNotFollowedByWrongConclusions) {
  const auto is_conclusion = testing::AnyOf(HasSubstr("sole"), HasSubstr("T-pose is"),
                                            HasSubstr("speed"), HasSubstr("ik.json)"));
  edit([](Profile& profile) { profile["foo"] = 1; });
  EXPECT_THAT(findings(true), ElementsAre(AllOf(HasSubstr("robot.json: unknown key \"foo\""))));
  EXPECT_THAT(findings(false), Each(Not(is_conclusion)));
  write("{\"name\": \"mine\",}");
  EXPECT_THAT(findings(true), ElementsAre(HasSubstr("robot.json:1:17: invalid JSON")));
  EXPECT_THAT(findings(false), IsEmpty());
  write(profile_);
  folder_.write("mine/ik.json", "{\"use_ik_match_table1\": \"yes\"");
  EXPECT_THAT(findings(true), ElementsAre(StartsWith(config_ + ":1:")));
  EXPECT_THAT(findings(false), Each(Not(HasSubstr("ik.json"))));
  EXPECT_THAT(findings(false), Contains(HasSubstr("no speed limit")));
  // Both files.
  write("{");
  EXPECT_THAT(findings(true), ElementsAre(HasSubstr("robot.json:1:2"), HasSubstr("ik.json:1:")));
}

TEST_F(ProfileChecksTest, ErrorsOfTheModelEndTheCheck) {
  folder_.write("mine/model.xml", "<mujoco>");
  for (const bool has_profile : {true, false}) {
    if (!has_profile) std::filesystem::remove(folder_.path() / "mine/robot.json");
    const auto found = check_robot(find_robot_sources(robot(), RETARGET_SOURCE_DIR).value());
    ASSERT_FALSE(found.has_value());
    EXPECT_THAT(found.error().location.file, HasSubstr("model.xml"));
  }
}

TEST_F(ProfileChecksTest, NotesMovingJointsWithoutAColumn) {
  const std::string what = "\"joint_order\" in robot.json leaves out joints";
  EXPECT_THAT(findings(false), Not(Contains(HasSubstr(what))));
  edit([](Profile& profile) {
    auto& order = profile["joint_order"];
    order.erase(std::ranges::find(order, "left_knee"));
  });
  EXPECT_THAT(findings(true), IsEmpty());
  EXPECT_THAT(findings(false), Contains(AllOf(HasSubstr(what), HasSubstr("left_knee"))));
}

// The base is read from a profile that has other errors.
TEST_F(ProfileChecksTest, FaultyProfilesMayFixTheBase) {
  std::string model = tiny_humanoid(true);
  const std::string joint = "<freejoint/>";
  model.replace(model.find(joint), joint.size(), "");
  folder_.write("mine/model.xml", model);
  folder_.write("mine/ik.json", "{}");
  edit([](Profile& profile) {
    profile["base"] = "fixed";
    profile["foo"] = 1;
  });
  EXPECT_THAT(findings(true), Contains(HasSubstr("unknown key \"foo\"")));
}

TEST_F(ProfileChecksTest, ListsContainRobotsWithErrors) {
  write("{");
  RobotSources broken = find_robot_sources(robot(), RETARGET_SOURCE_DIR).value();
  broken.name = "broken";
  RobotSources whole = find_robot_sources("unitree_h1", RETARGET_SOURCE_DIR).value();
  whole.name = "unitree_h1";
  const std::vector<RobotSources> robots = {broken, whole};
  const std::string text = describe_robots(robots, TextForm::kPlain).value();
  EXPECT_THAT(text, StartsWith("broken "));
  EXPECT_THAT(text, HasSubstr("error: " + broken.profile + ":1:2: invalid JSON"));
  EXPECT_THAT(text, HasSubstr("\nunitree_h1 "));
  const Profile json = Profile::parse(describe_robots(robots, TextForm::kJson).value());
  ASSERT_EQ(json.size(), 2U);
  EXPECT_THAT(json[0]["error"].get<std::string>(), HasSubstr(":1:2: invalid JSON"));
  EXPECT_TRUE(json[0]["joints"].is_null());
  EXPECT_TRUE(json[0]["installed"].get<bool>());
  EXPECT_TRUE(json[1]["error"].is_null());
  EXPECT_EQ(json[1]["joints"], 19);
}

}  // namespace
}  // namespace retarget
