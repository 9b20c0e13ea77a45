#include "retarget/retargeting_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/shared_data.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using OrderedJson = nlohmann::ordered_json;

// A valid retargeting configuration with two bodies of the two-armed robot.
OrderedJson good_config() {
  return OrderedJson::parse(R"({
    "robot_root_name": "base", "human_root_name": "Hips", "ground_height": 0.1,
    "human_height_assumption": 1.8,
    "use_ik_match_table1": true, "use_ik_match_table2": true,
    "human_scale_table": {"Hips": 0.9, "LeftArm": 0.75},
    "ik_match_table1": {
      "base": ["Hips", 0, 10, [0, 0, 0], [1, 0, 0, 0]],
      "left_upper": ["LeftArm", 5, 0, [0.1, 0.2, 0.3], [0.0, 0.0, 0.0, 1.0005]]
    },
    "ik_match_table2": {
      "left_upper": ["LeftArm", 5, 0, [0, 0, 0], [0, 0, 0, 1]],
      "base": ["Hips", 100, 10, [0, 0, 0], [1, 0, 0, 0]]
    }
  })");
}

Result<RetargetingConfig> parse(const OrderedJson& json) {
  return parse_retargeting_config(json.dump(), "map.json");
}

std::string fault_of(const OrderedJson& json) {
  const auto config = parse(json);
  if (!config) {
    EXPECT_EQ(config.error().kind, ErrorKind::kConfig);
    EXPECT_EQ(config.error().location.file, "map.json");
    return describe(config.error());
  }
  const auto checked = resolve_config(*config, *robot_from_text(kTwoArms));
  if (checked) return "no fault";
  EXPECT_EQ(checked.error().kind, ErrorKind::kConfig);
  return describe(checked.error());
}

TEST(RetargetingConfig, ReadsAMappingInFileOrder) {
  const auto config = value_of(parse(good_config()));
  EXPECT_EQ(fault_of(good_config()), "no fault");
  EXPECT_EQ(config.robot_root, "base");
  EXPECT_EQ(config.human_root, "Hips");
  EXPECT_EQ(config.ground_height, 0.1);
  ASSERT_EQ(config.match_tables[1].rows.size(), 2u);
  EXPECT_EQ(config.match_tables[1].rows[0].body, "left_upper");
  EXPECT_EQ(config.match_tables[1].rows[1].position_weight, 100.0);
  const IkMatch& row = config.match_tables[0].rows[1];
  EXPECT_EQ(row.bone, "LeftArm");
  EXPECT_EQ(row.position_offset, Eigen::Vector3d(0.1, 0.2, 0.3));
  // Within 1e-3 of a unit quaternion: normalised.
  EXPECT_EQ(row.rotation_offset.coeffs(), Eigen::Vector4d(0, 0, 1, 0));
  EXPECT_EQ(*config.find_scale("LeftArm"), 0.75);
  EXPECT_EQ(config.find_scale("RightArm"), nullptr);
}

TEST(RetargetingConfig, ReadsTheMappingOfTheRepository) {
  const auto config = value_of(load_retargeting_config(std::string(RETARGET_SOURCE_DIR) +
                                                       "/configs/lafan1_to_unitree_g1.json"));
  const auto checked = resolve_config(config, *load_g1());
  EXPECT_TRUE(checked) << describe(checked.error());
}

TEST(RetargetingConfig, SyntaxErrorsHaveLineAndColumn) {
  const auto config =
      parse_retargeting_config("{\n  \"ground_height\": 0.0,\n  oops\n}", "map.json");
  ASSERT_FALSE(config);
  EXPECT_EQ(config.error().kind, ErrorKind::kConfig);
  EXPECT_EQ(config.error().location.line, 3u);
  EXPECT_EQ(config.error().location.column, 3u);
}

TEST(RetargetingConfig, MissingFileIsAConfigurationError) {
  const auto config = load_retargeting_config("no/such/map.json");
  ASSERT_FALSE(config);
  EXPECT_EQ(config.error().kind, ErrorKind::kConfig);
}

TEST(RetargetingConfig, ReportsWrongTypesAndMissingKeysTogether) {
  OrderedJson json = good_config();
  json.erase("robot_root_name");
  json["human_height_assumption"] = -1;
  json["ik_match_table1"]["base"][1] = "heavy";
  json["ik_match_table1"]["left_upper"][4] = {1, 1, 0, 0};
  json["ik_match_table2"]["base"] = {"Hips", 1, 2};
  json["use_ik_match_table2"] = "yes";
  EXPECT_THAT(fault_of(json),
              AllOf(HasSubstr("6 errors"), HasSubstr("\"robot_root_name\" is missing"),
                    HasSubstr("must be more than 0"), HasSubstr("\"heavy\""),
                    HasSubstr("not a unit quaternion"), HasSubstr("[bone, position weight"),
                    HasSubstr("must be true or false")));
}

TEST(RetargetingConfig, ScalesMustBePositive) {
  for (const double scale : {0.0, -1.0}) {
    OrderedJson json = good_config();
    json["human_scale_table"]["Hips"] = scale;
    EXPECT_THAT(fault_of(json), HasSubstr("scale of \"Hips\" must be more than 0"));
  }
}

TEST(RetargetingConfig, ReportsUnknownBodiesAndBonesTogether) {
  OrderedJson json = good_config();
  json["robot_root_name"] = "bsae";
  json["human_root_name"] = "hips";
  json["ik_match_table1"]["left_uper"] = {"LeftFoot", 1, 1, {0, 0, 0}, {1, 0, 0, 0}};
  json["ik_match_table2"]["right_upper"] = {"RigthArm", 1, 1, {0, 0, 0}, {1, 0, 0, 0}};
  EXPECT_THAT(fault_of(json),
              AllOf(HasSubstr("\"bsae\" (did you mean \"base\"?)"),
                    HasSubstr("\"hips\" (did you mean \"Hips\"?)"),
                    HasSubstr("\"left_uper\" (did you mean \"left_upper\"?)"),
                    HasSubstr("\"RigthArm\" (did you mean \"RightArm\"?)"),
                    HasSubstr("\"LeftFoot\" has no entry in \"human_scale_table\"")));
}

TEST(RetargetingConfig, RejectsTwoBodiesOnOneBone) {
  OrderedJson json = good_config();
  json["ik_match_table2"]["right_upper"] = {"LeftArm", 1, 1, {0, 0, 0}, {1, 0, 0, 0}};
  EXPECT_THAT(fault_of(json), HasSubstr("\"LeftArm\" drives two bodies, \"left_upper\" and "
                                        "\"right_upper\""));
  // A row without weight is not a task.
  json["ik_match_table2"]["right_upper"] = {"LeftArm", 0, 0, {0, 0, 0}, {1, 0, 0, 0}};
  EXPECT_EQ(fault_of(json), "no fault");
}

TEST(RetargetingConfig, IgnoresDisabledTables) {
  OrderedJson json = good_config();
  json["ik_match_table2"]["no_such_body"] = {"NoSuchBone", 1, 1, {0, 0, 0}, {1, 0, 0, 0}};
  EXPECT_THAT(fault_of(json), HasSubstr("no_such_body"));
  json["use_ik_match_table2"] = false;
  EXPECT_EQ(fault_of(json), "no fault");
  json["use_ik_match_table1"] = false;
  EXPECT_THAT(fault_of(json), HasSubstr("no body would move"));
}

TEST(ResolvedConfig, ResolvesNamesToIndices) {
  const auto robot = robot_from_text(kTwoArms);
  const auto config = resolve_config(parse(good_config()).value(), *robot).value();
  EXPECT_EQ(config.root_body, *robot->find_body("base"));
  EXPECT_EQ(config.root_bone, Bone::kHips);
  EXPECT_EQ(config.scales[Bone::kLeftArm], 0.75);
  const ConfigTask& task = config.match_tables[1].tasks[0];
  EXPECT_EQ(task.body, *robot->find_body("left_upper"));
  EXPECT_EQ(task.bone, Bone::kLeftArm);
  EXPECT_EQ(config.body_of(Bone::kLeftArm), task.body);
  EXPECT_EQ(config.body_of(Bone::kHead), -1);
}

TEST(ResolvedConfig, FindsTheFirstTaskOfABoneThatHasAWeight) {
  OrderedJson json = good_config();
  json["ik_match_table1"]["left_upper"] = {"LeftArm", 0, 0, {1, 0, 0}, {1, 0, 0, 0}};
  const auto robot = robot_from_text(kTwoArms);
  const auto config = resolve_config(parse(json).value(), *robot).value();
  const ConfigTask* const task = config.find_task(Bone::kLeftArm);
  ASSERT_NE(task, nullptr);
  EXPECT_EQ(task->position_weight, 5.0);
  EXPECT_EQ(config.find_task(Bone::kRightArm), nullptr);
}

TEST(ResolvedConfig, CanRemoveBonesUnlessNothingIsLeft) {
  auto config = resolve_config(parse(good_config()).value(), *robot_from_text(kTwoArms)).value();
  EXPECT_EQ(leave_out_bones(config, std::array{Bone::kLeftArm, Bone::kHead}).value(), 2);
  EXPECT_EQ(config.find_task(Bone::kLeftArm), nullptr);
  const auto nothing = leave_out_bones(config, std::array{Bone::kHips});
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().message, HasSubstr("no body would move"));
}

TEST(RetargetingConfig, ReadsAllPublishedMappings) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  int count = 0;
  for (const char* folder : {"ik_configs", "ik_configs_2026"}) {
    for (const auto& entry : std::filesystem::directory_iterator(*shared / "reference" / folder)) {
      const auto config = load_retargeting_config(entry.path().string());
      EXPECT_TRUE(config) << describe(config.error());
      ++count;
    }
  }
  EXPECT_GE(count, 21);
}

}  // namespace
}  // namespace retarget
