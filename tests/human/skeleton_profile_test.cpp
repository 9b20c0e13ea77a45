#include "human/skeleton/skeleton_profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "human/skeleton/recognise.h"
#include "human/tiny_skeleton.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

TEST(SkeletonProfile, ReadsEveryKey) {
  const auto profile = value_of(parse_skeleton_profile(R"({
    "description": "a kind",
    "joints": {"Hips": "Pelvis", "LeftToe": ["LToe", "LBall"]},
    "required": ["Pelvis"], "others": ["Tip"], "marks": ["kind:"],
    "parents": {"LToe": "LFoot"}, "directions": {"LToe": [0, 0, 2]},
    "height_m": 1.7, "metres_per_unit": 0.0254, "up": [0, 0, 1], "rest_pose": "zero"
  })",
                                                       "kind", "kind.json"));
  EXPECT_EQ(profile.name, "kind");
  EXPECT_EQ(profile.names[Bone::kHips], std::vector<std::string>{"Pelvis"});
  EXPECT_EQ(profile.names[Bone::kLeftToe], (std::vector<std::string>{"LToe", "LBall"}));
  EXPECT_EQ(profile.directions[0].second, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(profile.facts.height, 1.7);
  EXPECT_EQ(profile.facts.metres_per_unit, 0.0254);
  EXPECT_EQ(profile.facts.up, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(profile.facts.rest, RestPose::kZero);
}

TEST(SkeletonProfile, ReportsEveryError) {
  const auto profile = parse_skeleton_profile(R"({
    "joints": {"LeftUpleg": "Thigh", "Hips": 3}, "requird": [], "height_m": -1,
    "up": [0, 0, 0], "rest_pose": "zerro"
  })",
                                              "kind", "kind.json");
  ASSERT_FALSE(profile);
  EXPECT_EQ(profile.error().kind, ErrorKind::kConfig);
  for (const char* part :
       {"did you mean \"LeftUpLeg\"", "did you mean \"required\"", "\"height_m\" must be",
        "\"up\" must be", "did you mean \"zero\"", "\"joints\", \"Hips\" must be"}) {
    EXPECT_THAT(full_message(profile.error()), HasSubstr(part));
  }
  EXPECT_FALSE(parse_skeleton_profile("[]", "kind", "kind.json"));
  EXPECT_THAT(parse_skeleton_profile("{}", "kind", "kind.json").error().message,
              HasSubstr("\"joints\""));
}

TEST(SkeletonProfile, RejectsEmptyFolders) {
  const TemporaryFolder folder;
  EXPECT_FALSE(load_skeleton_profiles(folder.path()));
  EXPECT_FALSE(load_skeleton_profiles(folder.path() / "none"));
  std::ignore = folder.write("b.json", R"({"joints": {"Hips": "B"}})");
  std::ignore = folder.write("a.json", R"({"joints": {"Hips": "A"}})");
  std::ignore = folder.write("notes.txt", "no skeleton profile");
  const auto profiles = value_of(load_skeleton_profiles(folder.path()));
  ASSERT_EQ(profiles.size(), 2U);
  EXPECT_EQ(profiles.at(0).name, "a");
}

TEST(SkeletonProfile, ReadsChangedFilesAgain) {
  const TemporaryFolder folder;
  for (const std::string joint : {"A", "B"}) {
    std::ignore = folder.write("kind.json", R"({"joints": {"Hips": ")" + joint + R"("}})");
    const auto profiles = load_skeleton_profiles(folder.path());
    ASSERT_TRUE(profiles);
    EXPECT_THAT(profiles->at(0).names[Bone::kHips], testing::ElementsAre(joint));
  }
  std::ignore = folder.write("kind.json", "");
  EXPECT_FALSE(load_skeleton_profiles(folder.path()));
}

// A body with exactly the joint names of a profile; empty for kinds with other trees.
Skeleton body_of_profile(const SkeletonProfile& profile) {
  const Skeleton body = tiny_skeleton(kBody);
  std::vector<Joint> joints;
  std::vector<int> new_index(body.joint_count(), -1);
  for (int i = 0; i < body.joint_count(); ++i) {
    Joint joint = body.joint(i);
    const auto& names = profile.names[bone_from_name(joint.name).value()];
    int parent = joint.parent;
    // A bone that the kind lacks is skipped.
    while (parent >= 0 && new_index[parent] < 0) {
      joint.offset += body.joint(parent).offset;
      parent = body.joint(parent).parent;
    }
    if (names.empty()) continue;
    joint.name = names[0];
    joint.parent = parent < 0 ? -1 : new_index[parent];
    new_index[i] = static_cast<int>(joints.size());
    joints.push_back(std::move(joint));
  }
  for (const std::string& name : profile.required) {
    if (std::ranges::find(joints, name, &Joint::name) != joints.end()) continue;
    Joint further;
    further.name = name;
    further.parent = 0;
    joints.push_back(std::move(further));
  }
  return Skeleton(std::move(joints));
}

// Every included profile must be found by its own names, or one that maps to the same joints.
TEST(SkeletonProfile, IncludedDialectsRecogniseTheirOwnNames) {
  for (const SkeletonProfile& profile : shipped_profiles()) {
    SCOPED_TRACE(profile.name);
    EXPECT_FALSE(profile.description.empty());
    if (profile.name == "slimevr" || !profile.parents.empty() || !profile.directions.empty()) {
      continue;
    }
    const Skeleton skeleton = body_of_profile(profile);
    const auto map = value_of(recognise_skeleton(skeleton, shipped_profiles()));
    for (const Bone bone : kMappedBones) {
      if (profile.names[bone].empty()) continue;
      EXPECT_EQ(joint_name(map, skeleton, std::string(bone_name(bone)).c_str()),
                profile.names[bone][0])
          << "as " << map.profile;
    }
  }
}

// The skeleton without the joints of some bones and their descendants.
Skeleton without_bones(const Skeleton& skeleton, const SkeletonProfile& profile,
                       std::initializer_list<std::string_view> bones) {
  std::vector<Joint> joints;
  std::vector<int> new_index(skeleton.joint_count(), -1);
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    Joint joint = skeleton.joint(i);
    const bool is_gone = std::ranges::any_of(bones, [&](std::string_view bone) {
      return profile.names[bone_from_name(bone).value()][0] == joint.name;
    });
    if (is_gone || (joint.parent >= 0 && new_index[joint.parent] < 0)) continue;
    if (joint.parent >= 0) joint.parent = new_index[joint.parent];
    new_index[i] = static_cast<int>(joints.size());
    joints.push_back(std::move(joint));
  }
  return Skeleton(std::move(joints));
}

TEST(SkeletonProfile, EveryDialectAcceptsBodiesWithoutLegs) {
  for (const SkeletonProfile& profile : shipped_profiles()) {
    SCOPED_TRACE(profile.name);
    // One kind has no arms; the required joints of the other are next to the legs here.
    if (profile.name == "slimevr" || profile.name == "makehuman_default") continue;
    const Skeleton body = body_of_profile(profile);
    const Skeleton upper = without_bones(body, profile, {"LeftUpLeg", "RightUpLeg"});
    const Skeleton one_leg = without_bones(body, profile, {"LeftUpLeg"});
    for (const Skeleton& part : {upper, one_leg}) {
      const auto map = recognise_skeleton(part, shipped_profiles(), {.partial = true});
      if (!map) {
        ADD_FAILURE() << describe(map.error());
        continue;
      }
      EXPECT_TRUE(map->partial);
      EXPECT_EQ(joint_name(*map, part, "Hips"), profile.names[Bone::kHips][0]);
      EXPECT_EQ(map->joint(Bone::kLeftUpLeg), -1);
    }
  }
}

TEST(SkeletonProfile, IgnoresMiddleMarks) {
  const Skeleton body = tiny_skeleton(kBody);
  std::vector<Joint> joints = body.joints();
  const auto rename = [&](const std::string& from, const std::string& to) {
    std::ranges::find(joints, from, &Joint::name)->name = "J_Bip_" + to;
  };
  for (const auto& [from, to] :
       std::vector<std::pair<const char*, const char*>>{{"Hips", "Hips"},
                                                        {"Spine", "Spine"},
                                                        {"Spine1", "Chest"},
                                                        {"Spine2", "UpperChest"},
                                                        {"Neck", "Neck"},
                                                        {"Head", "Head"}}) {
    rename(from, std::string("C_") + to);
  }
  for (const std::string side : {"Left", "Right"}) {
    for (const auto& [from, to] :
         std::vector<std::pair<const char*, const char*>>{{"UpLeg", "UpperLeg"},
                                                          {"Leg", "LowerLeg"},
                                                          {"Foot", "Foot"},
                                                          {"ToeBase", "ToeBase"},
                                                          {"Shoulder", "Shoulder"},
                                                          {"Arm", "UpperArm"},
                                                          {"ForeArm", "LowerArm"},
                                                          {"Hand", "Hand"}}) {
      rename(side + from, side.substr(0, 1) + "_" + to);
    }
  }
  // Hair hangs from the head.
  const auto head = std::ranges::find(joints, "J_Bip_C_Head", &Joint::name) - joints.begin();
  for (int i = 0; i < 20; ++i) {
    Joint hair;
    hair.name = "J_Sec_Hair" + std::to_string(i);
    hair.parent = static_cast<int>(head);
    hair.offset = Eigen::Vector3d(0.5 * i - 5, 10, -5);
    joints.push_back(hair);
  }
  const Skeleton skeleton(joints);
  for (const auto& profiles : {shipped_profiles(), std::vector<SkeletonProfile>()}) {
    const auto map = value_of(recognise_skeleton(skeleton, profiles));
    EXPECT_EQ(map.profile, profiles.empty() ? "names" : "vroid");
    EXPECT_EQ(joint_name(map, skeleton, "Neck"), "J_Bip_C_Neck");
    EXPECT_EQ(joint_name(map, skeleton, "Head"), "J_Bip_C_Head");
    EXPECT_EQ(joint_name(map, skeleton, "Spine2"), "J_Bip_C_UpperChest");
    EXPECT_EQ(joint_name(map, skeleton, "LeftLeg"), "J_Bip_L_LowerLeg");
  }
}

}  // namespace
}  // namespace retarget
