// One table of options: reading, writing, documentation.

#include "retarget/option_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "app/options/options_json.h"
#include "retarget/file.h"
#include "support/temporary_folder.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;

// A run's table with one additional option.
struct Extended {
  retarget::Run run;
  double depth = 1.5;
  OptionTable table = run_table(run);

  Extended() {
    table.push_back(
        option("new-depth", depth,
               {.type = "M", .group = "Input", .help = "How deep", .min = 0.0, .max = 10.0}));
  }
};

TEST(OptionTable, SingleRowRoundTrips) {
  Extended options;
  EXPECT_EQ(options_json(options.table)["new-depth"], 1.5);
  ASSERT_TRUE(read_options(Json{{"new-depth", 2.5}, {"precision", 9}}, options.table, "a", "it"));
  EXPECT_EQ(options.depth, 2.5);
  EXPECT_EQ(options.run.options.save.precision, 9);
}

TEST(OptionTable, SingleRowSuggestsAndValidates) {
  Extended options;
  const auto wrong = read_options(Json{{"new-dept", 1}}, options.table, "a.json", "it");
  ASSERT_FALSE(wrong);
  EXPECT_THAT(describe(wrong.error()), HasSubstr("did you mean \"new-depth\""));
  const auto beyond = read_options(Json{{"new-depth", 11}}, options.table, "a.json", "it");
  ASSERT_FALSE(beyond);
  EXPECT_THAT(describe(beyond.error()), HasSubstr("a number from 0 to 10"));
  EXPECT_EQ(options.depth, 1.5);
}

TEST(OptionTable, SelectsRowsByUse) {
  RobotChoice robot;
  EXPECT_THAT(option_names(rows_for(OptionUse::kConvert, robot_table(robot))),
              ElementsAre("robot", "robot-xml", "robot-profile", "dof", "base"));
  EXPECT_THAT(option_names(rows_not_for(OptionUse::kConvert, robot_table(robot))),
              ElementsAre("follow"));
  EXPECT_THAT(option_names(rows_for(OptionUse::kMeasure | OptionUse::kLive, robot_table(robot))),
              testing::SizeIs(6));
}

TEST(OptionTable, OmitsRowsOfAnotherTable) {
  RobotChoice robot;
  const OptionTable taken = rows_for(OptionUse::kConvert, robot_table(robot));
  EXPECT_THAT(option_names(without_rows_of(taken, robot_table(robot))), ElementsAre("follow"));
  EXPECT_THAT(option_names(without(taken, {"robot", "dof", "unknown"})),
              ElementsAre("robot-xml", "robot-profile", "base"));
}

TEST(OptionTable, FilesRoundTrip) {
  Extended written, read;
  written.depth = 2.5;
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "options.json").string();
  ASSERT_TRUE(write_file(file, options_text(written.table)));
  ASSERT_TRUE(load_options(file, read.table, "the options"));
  EXPECT_EQ(read.depth, 2.5);
  EXPECT_FALSE(load_options(file + ".missing", read.table, "the options"));
}

TEST(OptionTable, RunsRoundTrip) {
  retarget::Run run;
  run.motion = "a \xff.bvh";  // The name is not valid UTF-8.
  run.robot.name = "unitree_g1";
  run.options.human.up = -Eigen::Vector3d::UnitZ();
  run.options.human.rest = RestPose::kLearned;
  run.options.time.fps = std::nullopt;
  run.options.save.formats = {MotionFormat::kCsv, MotionFormat::kPklGmr};
  run.options.save.npz_velocity = BodyPoint::kMass;
  run.options.part.start_s = 0.25;
  run.options.solve.without = {"floor"};
  const Json json = options_json(run_table(run));
  retarget::Run back;
  ASSERT_TRUE(read_options(json, run_table(back), "a", "the options"));
  EXPECT_EQ(back.motion, run.motion);
  EXPECT_EQ(back.options.human.up, run.options.human.up);
  EXPECT_EQ(back.options.time.fps, std::nullopt);
  EXPECT_EQ(options_json(run_table(back)), json);
}

TEST(OptionTable, OutOfRangeDefaultsRoundTrip) {
  retarget::Run run;
  retarget::Run back;
  EXPECT_TRUE(read_options(options_json(run_table(run)), run_table(back), "a", "the options"));
}

TEST(OptionTable, ReportsEveryError) {
  retarget::Run run;
  const auto read = read_options(Json{{"method", "fitt"},
                                      {"precision", 18},
                                      {"lenient", 1},
                                      {"up", "w"},
                                      {"fps", "x"},
                                      {"format", {"csv", "nzp"}},
                                      {"tpose-frame", 1.5},
                                      {"npz-fps", 1e300}},
                                 run_table(run), "a.json", "the options");
  ASSERT_FALSE(read);
  const std::string text = describe(read.error());
  for (const char* part :
       {"\"method\" must be one of fit, gmr", "\"precision\" must be a whole number from 0 to 17",
        "\"lenient\" must be true or false", "\"up\"", "\"fps\"", "some of csv", "\"tpose-frame\"",
        "\"npz-fps\""}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_EQ(read.error().details.size(), 8U);
}

TEST(OptionTable, ReadsValuesFromText) {
  retarget::Run run;
  const OptionTable table = run_table(run);
  const auto value = [&](const char* name, const char* text) {
    return option_value(*find_option(table, name), text);
  };
  EXPECT_EQ(value("precision", "06").value(), OptionValue(std::int64_t{6}));
  EXPECT_EQ(value("height", "1.80").value(), OptionValue(1.8));
  EXPECT_EQ(value("lenient", "true").value(), OptionValue(true));
  for (const auto& [name, text] : {std::pair("precision", "x"),
                                   {"precision", "1.5"},
                                   {"height", "nan"},
                                   {"height", "20"},
                                   {"method", "gm"},
                                   {"precision", ""},
                                   {"height", "1.8m"},
                                   {"source-fps", "1e400"}}) {
    EXPECT_FALSE(value(name, text)) << name << " " << text;
  }
  EXPECT_THAT(value("method", "fti").error().message, HasSubstr("did you mean \"fit\""));
}

TEST(OptionTable, NamesAreUnique) {
  retarget::Run run;
  const std::vector<std::string> names = option_names(run_table(run));
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  FitOptions fit;
  const std::vector<std::string> of_fit = option_names(fit_table(fit));
  EXPECT_EQ(std::set<std::string>(of_fit.begin(), of_fit.end()).size(), of_fit.size());
}

TEST(OptionTable, EveryRowHasHelp) {
  retarget::Run run;
  FitOptions fit;
  OptionTable table = run_table(run);
  append(table, fit_table(fit));
  for (const Option& row : table) {
    EXPECT_FALSE(row.info.help.empty()) << row.name;
    EXPECT_FALSE(row.info.group.empty()) << row.name;
    EXPECT_FALSE(row.info.help.ends_with('.') && !row.info.help.ends_with("...")) << row.name;
  }
}

}  // namespace
}  // namespace retarget
