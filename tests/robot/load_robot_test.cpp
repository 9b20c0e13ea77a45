#include "base/json.h"
#include "base/option_name.h"
#include "retarget/robots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// A folder with the robots maker_one and maker_two (without a profile) and entries of other kinds.
class FindRobotTest : public testing::Test {
 protected:
  FindRobotTest() {
    for (const char* name : {"maker_two", "maker_one", "no_robot"}) {
      fs::create_directory(folder_.path() / name);
    }
    folder_.write("maker_one/model.xml", "");
    folder_.write("maker_one/robot.json", "");
    folder_.write("maker_two/model.xml", "");
    folder_.write("model.txt", "");
  }

  [[nodiscard]] Error error_of(const std::string& name) const {
    const auto found = find_robot(name, {folder_.path()});
    EXPECT_FALSE(found.has_value()) << name;
    if (found) return {};
    EXPECT_EQ(found.error().kind, ErrorKind::kConfig);
    return found.error();
  }

  TemporaryFolder folder_;
};

TEST_F(FindRobotTest, FindsByName) {
  const auto found = value_of(find_robot("maker_one", {folder_.path()}));
  EXPECT_EQ(found.model, folder_.path() / "maker_one" / "model.xml");
  EXPECT_EQ(found.profile, folder_.path() / "maker_one" / "robot.json");
}

TEST_F(FindRobotTest, FindsFolderWithoutProfile) {
  const fs::path folder = folder_.path() / "maker_two";
  const auto found = value_of(find_robot(folder.string(), {"no/such/folder"}));
  EXPECT_EQ(found.model, folder / "model.xml");
  EXPECT_TRUE(found.profile.empty());
}

TEST_F(FindRobotTest, UnknownNamesSuggestAndList) {
  const Error typing_mistake = error_of("Maker_on");
  EXPECT_THAT(typing_mistake.message, AllOf(HasSubstr("Maker_on"), HasSubstr("\"maker_one\"?")));
  EXPECT_THAT(typing_mistake.hint, HasSubstr("maker_one, maker_two"));
  EXPECT_THAT(error_of("").message, AllOf(HasSubstr("no robot"), Not(HasSubstr("did you mean"))));
  EXPECT_THAT(find_robot("x", {"no/such/folder"}).error().hint, HasSubstr("no robots in"));
}

TEST_F(FindRobotTest, ResolvesUnambiguousShortNames) {
  fs::create_directory(folder_.path() / "maker_two_with_hands");
  folder_.write("maker_two_with_hands/model.xml", "");
  const auto whole_name = [&](const std::string& name) {
    const auto found = find_robot(name, {folder_.path()});
    return found ? found->name : describe(found.error());
  };
  for (const char* name : {"one", "One", "maker-one", "MAKER_ONE", "maker one"}) {
    EXPECT_EQ(whole_name(name), "maker_one") << name;
  }
  // Names that end with the given words take precedence.
  EXPECT_EQ(whole_name("two"), "maker_two");
  EXPECT_EQ(whole_name("hands"), "maker_two_with_hands");
  EXPECT_EQ(find_robot("two", {folder_.path()})->model, folder_.path() / "maker_two" / "model.xml");
  EXPECT_EQ(whole_name("maker_two"), "maker_two");
  const Error ambiguous = error_of("maker");
  EXPECT_THAT(ambiguous.message, HasSubstr("maker_one, maker_two, maker_two_with_hands"));
  // A part of a word does not select a robot.
  EXPECT_THAT(error_of("on").message, HasSubstr("no robot \"on\""));
  EXPECT_THAT(error_of("_").message, HasSubstr("no robot"));
}

// Two known robots are not installed; maker_two_29 is, and must not replace maker_two.
class NotInstalledTest : public testing::Test {
 protected:
  NotInstalledTest() {
    for (const char* name : {"maker_two_29", "other_four"})
      fs::create_directory(folder_.path() / name);
    folder_.write("maker_two_29/model.xml", "");
    folder_.write("other_four/model.xml", "");
    folder_.write("index.json", R"({"robots": [
      {"name": "maker_two", "description": "d", "licence": "none", "in_packages": false},
      {"name": "maker_two_29", "description": "d", "licence": "MIT", "in_packages": true},
      {"name": "maker_three", "description": "d", "licence": "MIT", "in_packages": true},
      {"name": "other_four", "description": "d", "licence": "MIT", "in_packages": true}]})");
  }

  [[nodiscard]] Error error_of(const std::string& name) const {
    const auto found = find_robot(name, {folder_.path()});
    EXPECT_FALSE(found.has_value()) << name << " is " << found->name;
    if (found) return {};
    EXPECT_EQ(found.error().kind, ErrorKind::kConfig);
    return found.error();
  }

  TemporaryFolder folder_;
};

TEST_F(NotInstalledTest, AFullNameNeverMatchesAnotherRobot) {
  for (const char* name : {"maker_two", "Maker-Two", "MAKER_TWO"}) {
    const Error error = error_of(name);
    EXPECT_EQ(error.message,
              "the robot maker_two is not installed: its maker states no licence, so packages do "
              "not include it");
    EXPECT_THAT(error.hint,
                HasSubstr("retarget robots install maker_two " OPTION("source") " SOURCE"));
    EXPECT_TRUE(names_robot(name, {folder_.path()}));
  }
  EXPECT_EQ(error_of("maker_three").message, "the robot maker_three is not installed");
}

TEST_F(NotInstalledTest, AShortNameMeansTheSameInEveryInstall) {
  // If all are installed, `two` is maker_two.
  EXPECT_THAT(error_of("two").message, HasSubstr("maker_two is not installed"));
  EXPECT_THAT(error_of("three").message, HasSubstr("maker_three is not installed"));
  EXPECT_THAT(error_of("maker").message,
              HasSubstr("maker_three (not installed), maker_two (not installed), maker_two_29"));
  EXPECT_FALSE(names_robot("maker", {folder_.path()}));
  EXPECT_EQ(find_robot("29", {folder_.path()}).has_value(), false);
  EXPECT_EQ(find_robot("two_29", {folder_.path()})->name, "maker_two_29");
  EXPECT_EQ(find_robot("four", {folder_.path()})->name, "other_four");
  EXPECT_THAT(error_of("maker_tow").message, HasSubstr("did you mean \"maker_two\"?"));
}

TEST_F(NotInstalledTest, LaterFoldersAddRobots) {
  const TemporaryFolder own;
  fs::create_directories(own.path() / "unverified" / "maker_two");
  fs::create_directories(own.path() / "other_four");
  const std::string model = own.write("unverified/maker_two/model.xml", "");
  own.write("other_four/model.xml", "");
  const RobotFolders folders = {folder_.path(), own.path()};
  for (const char* name : {"maker_two", "two"}) {
    const auto found = value_of(find_robot(name, folders));
    EXPECT_EQ(found.model, model);
    EXPECT_TRUE(is_unverified(found.model));
  }
  // The first folder that contains a robot takes precedence.
  EXPECT_EQ(find_robot("four", folders)->model, folder_.path() / "other_four" / "model.xml");
  EXPECT_THAT(list_robots(folders), ElementsAre("maker_two", "maker_two_29", "other_four"));
}

TEST_F(NotInstalledTest, ReportsAFaultyIndex) {
  for (const char* text : {"[]", "{", R"({"robots": [3]})", R"({"robots": [{"naem": "x"}]})"}) {
    folder_.write("index.json", text);
    const auto found = find_robot("two", {folder_.path()});
    ASSERT_FALSE(found) << text;
    EXPECT_THAT(describe(found.error()), HasSubstr("index.json")) << text;
    // A robot with its full name needs no index.
    EXPECT_TRUE(find_robot("other_four", {folder_.path()}));
  }
}

TEST(RobotsFolderTest, IncludedRobotsHaveShortNames) {
  const fs::path robots = fs::path(RETARGET_SOURCE_DIR) / "robots";
  for (const auto& [name, whole] : {std::pair("g1", "unitree_g1"),
                                    {"G1", "unitree_g1"},
                                    {"h1", "unitree_h1"},
                                    {"h1_2", "unitree_h1_2"},
                                    {"t1", "booster_t1"},
                                    {"n1", "fourier_n1"},
                                    {"pm01", "engineai_pm01"},
                                    {"toddy", "stanford_toddy"},
                                    {"talos", "pal_talos"}}) {
    const auto found = find_robot(name, {robots});
    ASSERT_TRUE(found) << name << ": " << describe(found.error());
    EXPECT_EQ(found->name, whole);
  }
  for (const char* name : {"unitree", "lite", "booster", "2"}) {
    EXPECT_FALSE(find_robot(name, {robots})) << name;
  }
  EXPECT_THAT(find_robot("lite", {robots}).error().message,
              HasSubstr("berkeley_humanoid_lite, pnd_adam_lite"));
}

TEST_F(FindRobotTest, RejectsFoldersAndFilesThatAreNotRobots) {
  EXPECT_THAT(error_of((folder_.path() / "no_robot").string()).message,
              HasSubstr("no file model.xml"));
  EXPECT_THAT(error_of((folder_.path() / "model.txt").string()).hint,
              HasSubstr(OPTION("robot-xml")));
}

TEST_F(FindRobotTest, ListIsSortedAndContainsOnlyRobots) {
  EXPECT_THAT(list_robots({folder_.path()}), ElementsAre("maker_one", "maker_two"));
  EXPECT_THAT(list_robots({"no/such/folder"}), IsEmpty());
}

TEST(RobotsFolderTest, IncludesTheG1) {
  EXPECT_THAT(list_robots({fs::path(RETARGET_SOURCE_DIR) / "robots"}),
              ::testing::Contains("unitree_g1"));
}

TEST(RobotsFolderTest, IndexNamesEveryRobot) {
  const fs::path robots = fs::path(RETARGET_SOURCE_DIR) / "robots";
  const auto known = value_of(known_robots({robots}));
  std::vector<std::string> names;
  for (const KnownRobot& robot : known) {
    names.push_back(robot.name);
    const auto files = value_of(find_robot(robot.name, {robots}));
    EXPECT_EQ(robot.in_packages, !is_unverified(files.model)) << robot.name;
    const auto profile = value_of(load_json(files.profile.string()));
    EXPECT_EQ(robot.description, profile["description"]) << robot.name;
    EXPECT_EQ(robot.licence, profile["licence"]) << robot.name;
  }
  EXPECT_EQ(names, list_robots({robots}));
}

TEST(RobotsFolderTest, RobotsWithoutAStatedLicenceAreInASeparateFolder) {
  const fs::path robots = fs::path(RETARGET_SOURCE_DIR) / "robots";
  EXPECT_THAT(list_robots({robots}), ::testing::Contains("kuavo_s45"));
  EXPECT_EQ(find_robot("kuavo", {robots})->model, robots / "unverified/kuavo_s45/model.xml");
  EXPECT_TRUE(is_unverified(find_robot("kuavo_s45", {robots})->model));
  EXPECT_FALSE(is_unverified(find_robot("unitree_g1", {robots})->model));
}

}  // namespace
}  // namespace retarget
