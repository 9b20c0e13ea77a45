#include "human/skeleton/bone_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "human/skeleton/recognise.h"
#include "human/tiny_skeleton.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

TEST(BoneMapFile, RoundTrips) {
  const Skeleton skeleton = tiny_skeleton(replaced(kBody, "Spine1", "Chest"));
  const BoneMap map = recognise_skeleton(skeleton, {}).value();
  const TemporaryFolder folder;
  const std::string path = folder.write("map.json", format_bone_map(map, skeleton));
  const auto read = value_of(read_bone_map(path, skeleton));
  EXPECT_EQ(read.joint_of_bone, map.joint_of_bone);
  EXPECT_EQ(read.profile, "map file");
  EXPECT_EQ(read.confidence, 1.0);
  EXPECT_FALSE(read.partial);
}

TEST(BoneMapFile, WritesNullForBonesWithoutAJoint) {
  const Skeleton skeleton = tiny_skeleton("Hips 0 0 0\n  Spine 0 1 0\n");
  BoneMap map;
  map.joint_of_bone[Bone::kHips] = 0;
  const std::string text = format_bone_map(map, skeleton);
  EXPECT_THAT(text, HasSubstr("\"Hips\": \"Hips\""));
  EXPECT_THAT(text, HasSubstr("\"LeftUpLeg\": null"));
  const auto read = value_of(parse_bone_map(text, "map.json", skeleton));
  EXPECT_EQ(read.joint_of_bone, map.joint_of_bone);
  EXPECT_TRUE(read.partial);
}

TEST(BoneMapFile, ReportsAllErrorsTogether) {
  const Skeleton skeleton = tiny_skeleton(replaced(kBody, "RightToeBase", "LeftToeBase"));
  const auto read = parse_bone_map(R"({
    "Hips": "Hipz", "LeftUpleg": "LeftUpLeg", "Spine": "Spine", "Spine1": "Spine",
    "LeftToe": "LeftToeBase", "Head": 3
  })",
                                   "map.json", skeleton);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ErrorKind::kConfig);
  for (const char* part :
       {"no joint \"Hipz\" (did you mean \"Hips\"?)", "no bone \"LeftUpleg\" (did you mean",
        "\"Spine\" is given for two bones", "2 joints are called \"LeftToeBase\"",
        "\"Head\" must be a joint name or null"}) {
    EXPECT_THAT(full_message(read.error()), HasSubstr(part));
  }
}

TEST(BoneMapFile, RejectsBonesOutsideTheirChain) {
  const Skeleton skeleton = tiny_skeleton(kBody);
  const auto read = parse_bone_map(
      R"({"Hips": "Hips", "LeftUpLeg": "LeftUpLeg", "LeftLeg": "LeftFoot", "LeftFoot": "LeftLeg"})",
      "map.json", skeleton);
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message,
              HasSubstr("\"LeftLeg\" as \"LeftFoot\" is not below the bones"));
  EXPECT_THAT(parse_bone_map("{}", "map.json", skeleton).error().message,
              HasSubstr("\"Hips\" has no joint"));
}

// A stream has no skeleton yet when its options are checked.
TEST(BoneMapFile, IsCheckedWithoutASkeleton) {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& text) {
    return check_bone_map(folder.write("map.json", text));
  };
  EXPECT_TRUE(check(R"({"Hips": "pelvis", "Spine": null})"));
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"{", "invalid JSON"},
           {"[]", "must be a JSON object"},
           {R"({"Hips": "pelvis", "Spin": "a"})", "no bone \"Spin\" (did you mean"},
           {R"({"Hips": "pelvis", "LeftFootMod": "a"})", "no bone \"LeftFootMod\""},
           {R"({"Hips": 3})", "must be a joint name or null"},
           {R"({"Hips": null})", "\"Hips\" has no joint"},
           {R"({"Spine": "a"})", "\"Hips\" has no joint"}}) {
    const auto checked = check(text);
    ASSERT_FALSE(checked) << text;
    EXPECT_EQ(checked.error().kind, ErrorKind::kConfig);
    EXPECT_THAT(full_message(checked.error()), HasSubstr(message));
  }
}

TEST(BoneMap, RotationJointAboveTheHipsIsTheirParent) {
  const Skeleton skeleton = tiny_skeleton(R"(
HMD 0 0 0
  Neck 0 -10 0
    Chest 0 -30 0
      Hip 0 -20 0
        LeftHip -10 0 0
)");
  BoneMap map;
  map.joint_of_bone[Bone::kHips] = 3;
  map.joint_of_bone[Bone::kSpine2] = 2;
  map.joint_of_bone[Bone::kHead] = 0;
  map.joint_of_bone[Bone::kLeftUpLeg] = 4;
  EXPECT_EQ(rotation_joint(map, skeleton, Bone::kHips), 3);
  EXPECT_EQ(rotation_joint(map, skeleton, Bone::kSpine2), 1);
  EXPECT_EQ(rotation_joint(map, skeleton, Bone::kHead), 0);
  EXPECT_EQ(rotation_joint(map, skeleton, Bone::kLeftUpLeg), 4);
  EXPECT_EQ(rotation_joint(map, skeleton, Bone::kNeck), -1);
}

}  // namespace
}  // namespace retarget
