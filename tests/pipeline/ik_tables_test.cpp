#include "retarget/ik_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/shared_data.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

// a mapping of two bodies of the two-armed robot without fault
Json good_mapping() {
  return Json::parse(R"({
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

Result<IkTables> parse(const Json& json) {
  return parse_ik_tables(json.dump(), "map.json");
}

std::string fault_of(const Json& json) {
  const auto tables = parse(json);
  if (!tables) {
    EXPECT_EQ(tables.error().kind, ErrorKind::kConfig);
    EXPECT_EQ(tables.error().location.file, "map.json");
    return describe(tables.error());
  }
  const auto checked = resolve_mapping(*tables, *robot_from_text(kTwoArms));
  if (checked) return "no fault";
  EXPECT_EQ(checked.error().kind, ErrorKind::kConfig);
  return describe(checked.error());
}

TEST(IkTables, ReadsAMappingInFileOrder) {
  const auto tables = parse(good_mapping());
  ASSERT_TRUE(tables) << describe(tables.error());
  EXPECT_EQ(fault_of(good_mapping()), "no fault");
  EXPECT_EQ(tables->robot_root, "base");
  EXPECT_EQ(tables->human_root, "Hips");
  EXPECT_EQ(tables->ground_height, 0.1);
  ASSERT_EQ(tables->tables[1].rows.size(), 2u);
  EXPECT_EQ(tables->tables[1].rows[0].body, "left_upper");
  EXPECT_EQ(tables->tables[1].rows[1].position_weight, 100.0);
  const IkRow& row = tables->tables[0].rows[1];
  EXPECT_EQ(row.bone, "LeftArm");
  EXPECT_EQ(row.position_offset, Eigen::Vector3d(0.1, 0.2, 0.3));
  // within 1e-3 of a unit quaternion: normalised
  EXPECT_EQ(row.rotation_offset.coeffs(), Eigen::Vector4d(0, 0, 1, 0));
  EXPECT_EQ(*tables->find_scale("LeftArm"), 0.75);
  EXPECT_EQ(tables->find_scale("RightArm"), nullptr);
}

TEST(IkTables, ReadsTheMappingOfTheRepository) {
  const auto tables =
      load_ik_tables(std::string(RETARGET_SOURCE_DIR) + "/configs/lafan1_to_unitree_g1.json");
  ASSERT_TRUE(tables) << describe(tables.error());
  const auto checked = resolve_mapping(*tables, *load_g1());
  EXPECT_TRUE(checked) << describe(checked.error());
}

TEST(IkTables, SyntaxErrorsHaveLineAndColumn) {
  const auto tables = parse_ik_tables("{\n  \"ground_height\": 0.0,\n  oops\n}", "map.json");
  ASSERT_FALSE(tables);
  EXPECT_EQ(tables.error().kind, ErrorKind::kConfig);
  EXPECT_EQ(tables.error().location.line, 3u);
  EXPECT_EQ(tables.error().location.column, 3u);
}

TEST(IkTables, MissingFileIsAConfigurationError) {
  const auto tables = load_ik_tables("no/such/map.json");
  ASSERT_FALSE(tables);
  EXPECT_EQ(tables.error().kind, ErrorKind::kConfig);
}

TEST(IkTables, ReportsWrongTypesAndMissingKeysTogether) {
  Json json = good_mapping();
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

TEST(IkTables, ReportsUnknownBodiesAndBonesTogether) {
  Json json = good_mapping();
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

TEST(IkTables, RejectsTwoBodiesOnOneBone) {
  Json json = good_mapping();
  json["ik_match_table2"]["right_upper"] = {"LeftArm", 1, 1, {0, 0, 0}, {1, 0, 0, 0}};
  EXPECT_THAT(fault_of(json), HasSubstr("\"LeftArm\" drives two bodies, \"left_upper\" and "
                                        "\"right_upper\""));
  // a row without weight is no task
  json["ik_match_table2"]["right_upper"] = {"LeftArm", 0, 0, {0, 0, 0}, {1, 0, 0, 0}};
  EXPECT_EQ(fault_of(json), "no fault");
}

TEST(IkTables, IgnoresDisabledTables) {
  Json json = good_mapping();
  json["ik_match_table2"]["no_such_body"] = {"NoSuchBone", 1, 1, {0, 0, 0}, {1, 0, 0, 0}};
  EXPECT_THAT(fault_of(json), HasSubstr("no_such_body"));
  json["use_ik_match_table2"] = false;
  EXPECT_EQ(fault_of(json), "no fault");
  json["use_ik_match_table1"] = false;
  EXPECT_THAT(fault_of(json), HasSubstr("nothing would move"));
}

TEST(ResolvedMapping, ResolvesNamesToIndices) {
  const auto robot = robot_from_text(kTwoArms);
  const auto mapping = resolve_mapping(parse(good_mapping()).value(), *robot).value();
  EXPECT_EQ(mapping.root_body, *robot->find_body("base"));
  EXPECT_EQ(mapping.root_bone, Bone::kHips);
  EXPECT_EQ(mapping.scales[Bone::kLeftArm], 0.75);
  const MappedTask& task = mapping.tables[1].tasks[0];
  EXPECT_EQ(task.body, *robot->find_body("left_upper"));
  EXPECT_EQ(task.bone, Bone::kLeftArm);
  EXPECT_EQ(mapping.body_of(Bone::kLeftArm), task.body);
  EXPECT_EQ(mapping.body_of(Bone::kHead), -1);
}

TEST(ResolvedMapping, FindsTheFirstTaskOfABoneThatHasAWeight) {
  Json json = good_mapping();
  json["ik_match_table1"]["left_upper"] = {"LeftArm", 0, 0, {1, 0, 0}, {1, 0, 0, 0}};
  const auto robot = robot_from_text(kTwoArms);
  const auto mapping = resolve_mapping(parse(json).value(), *robot).value();
  const MappedTask* const task = mapping.find_task(Bone::kLeftArm);
  ASSERT_NE(task, nullptr);
  EXPECT_EQ(task->position_weight, 5.0);
  EXPECT_EQ(mapping.find_task(Bone::kRightArm), nullptr);
}

TEST(ResolvedMapping, CanRemoveBonesUnlessNothingIsLeft) {
  auto mapping = resolve_mapping(parse(good_mapping()).value(), *robot_from_text(kTwoArms)).value();
  EXPECT_EQ(leave_out_bones(mapping, std::array{Bone::kLeftArm, Bone::kHead}).value(), 2);
  EXPECT_EQ(mapping.find_task(Bone::kLeftArm), nullptr);
  const auto nothing = leave_out_bones(mapping, std::array{Bone::kHips});
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().message, HasSubstr("nothing would move"));
}

TEST(IkTables, ReadsAllPublishedMappings) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  int count = 0;
  for (const char* folder : {"ik_configs", "ik_configs_2026"}) {
    for (const auto& entry : std::filesystem::directory_iterator(*shared / "reference" / folder)) {
      const auto tables = load_ik_tables(entry.path().string());
      EXPECT_TRUE(tables) << describe(tables.error());
      ++count;
    }
  }
  EXPECT_GE(count, 21);
}

}  // namespace
}  // namespace retarget
