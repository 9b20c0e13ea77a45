#include <gtest/gtest.h>

#include <filesystem>

#include "base/option_name.h"
#include "formats/bvh/read_bvh.h"
#include "human/skeleton/recognise.h"
#include "human/tiny_skeleton.h"
#include "support/shared_data.h"
#include "support/value_of.h"

namespace retarget {
namespace {

// Expected bones, taken from notes on the data sets and from the files' trees.
struct Expected {
  const char* file;
  const char* profile;
  const char* hips;
  const char* torso;
  const char* arm;
  const char* thigh;
};

const std::vector<Expected> kExpected = {
    {"dialects/cmu_3dsmax_jumping_jacks.bvh", "cmu_3dsmax", "Hips", "Chest2", "LeftShoulder",
     "LeftHip"},
    {"dialects/cmu_daz_03_03.bvh", "cmu_daz", "hip", "chest", "lShldr", "lThigh"},
    {"dialects/cmu_motionbuilder_12_01_walk.bvh", "cmu_motionbuilder", "Hips", "Spine1", "LeftArm",
     "LeftUpLeg"},
    {"dialects/fair_vicon_zup_inch_jumping.bvh", "vicon", "Hips", "Spine3", "LeftArm", "LeftUpLeg"},
    {"dialects/games105_run_forward.bvh", "games105", "RootJoint", "lowerback_torso", "lShoulder",
     "lHip"},
    {"dialects/games105_walk60.bvh", "games105", "RootJoint", "lowerback_torso", "lShoulder",
     "lHip"},
    {"dialects/geno_stance.bvh", "lafan1_resolved", "Hips", "Spine3", "LeftArm", "LeftUpLeg"},
    {"dialects/makehuman_walk1.bvh", "makehuman", "Hips", "Spine3", "UpArm_L", "UpLeg_L"},
    {"dialects/move_avatar_walking.bvh", "move", "Hips", "Spine4", "LeftArm", "LeftThigh"},
    {"dialects/rokoko_dance_100fps.bvh", "rokoko", "Hips", "Spine2", "LeftArm", "LeftUpLeg"},
    {"dialects/soma_dance_120fps.bvh", "soma", "Hips", "Chest", "LeftArm", "LeftLeg"},
    {"dialects/soma_walk_forward_120fps.bvh", "soma", "Hips", "Chest", "LeftArm", "LeftLeg"},
    {"dialects/soma_zero_frame0.bvh", "soma", "Hips", "Chest", "LeftArm", "LeftLeg"},
    {"dialects/vicon_mixed_orders_zup_inch_1.bvh", "vicon", "Hips", "Spine3", "LeftArm",
     "LeftUpLeg"},
    {"dialects/xsens_boxing_120fps.bvh", "xsens", "Hips", "Chest4", "LeftShoulder", "LeftHip"},
    {"lafan1/dance1_subject2.bvh", "lafan1", "Hips", "Spine2", "LeftArm", "LeftUpLeg"},
    {"lafan1/fallAndGetUp2_subject2.bvh", "lafan1", "Hips", "Spine2", "LeftArm", "LeftUpLeg"},
    {"lafan1/ground1_subject1.bvh", "lafan1", "Hips", "Spine2", "LeftArm", "LeftUpLeg"},
    {"lafan1/walk4_subject1.bvh", "lafan1", "Hips", "Spine2", "LeftArm", "LeftUpLeg"},
    {"lafan1_cuts/dance1_subject1_stumbling_filtered_60fps.bvh", "lafan1", "Hips", "Spine2",
     "LeftArm", "LeftUpLeg"},
    {"lafan1_cuts/fight1_subject2_backward.bvh", "lafan1", "Hips", "Spine2", "LeftArm",
     "LeftUpLeg"},
    {"lafan1_cuts/jumps1_subject5_big.bvh", "lafan1", "Hips", "Spine2", "LeftArm", "LeftUpLeg"},
    {"lafan1_cuts/run2_subject4_run.bvh", "lafan1", "Hips", "Spine2", "LeftArm", "LeftUpLeg"},
    {"lafan1_cuts/walk1_subject1_walk.bvh", "lafan1", "Hips", "Spine2", "LeftArm", "LeftUpLeg"},
    {"quirks/00_reference.bvh", "biovision", "Hips", "Chest", "LeftUpArm", "LeftUpLeg"},
    {"quirks/06_names_with_spaces.bvh", "biovision", "Hips", "Chest", "Left Up Arm", "LeftUpLeg"},
    {"quirks/07_names_colon_dot_dash.bvh", "biovision", "mixamorig:Hips.L-x", "mixamorig:Chest.L-x",
     "mixamorig:LeftUpArm.L-x", "mixamorig:LeftUpLeg.L-x"},
    {"quirks/29_leaf_without_end_site.bvh", "biovision", "Hips", "Chest", "LeftUpArm", "LeftUpLeg"},
};

class RealFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = shared_folder();
    if (!folder_) GTEST_SKIP() << kNoSharedFolder;
  }
  [[nodiscard]] Clip load(const std::string& file) const {
    return load_bvh((*folder_ / "data" / file).string()).value().clip;
  }

  std::optional<std::filesystem::path> folder_;
};

TEST_F(RealFiles, AreRecognisedWithTheRightDialect) {
  for (const Expected& expected : kExpected) {
    SCOPED_TRACE(expected.file);
    const Clip clip = load(expected.file);
    const auto map = recognise_skeleton(clip, shipped_profiles());
    if (!map) {
      ADD_FAILURE() << describe(map.error());
      continue;
    }
    const auto name = [&](const char* bone) { return joint_name(*map, clip.skeleton(), bone); };
    EXPECT_EQ(map->profile, expected.profile);
    EXPECT_EQ(name("Hips"), expected.hips);
    EXPECT_EQ(name("Spine2"), expected.torso);
    EXPECT_EQ(name("LeftArm"), expected.arm);
    EXPECT_EQ(name("LeftUpLeg"), expected.thigh);
    EXPECT_GE(map->confidence, 0.9);
    EXPECT_FALSE(map->partial);
  }
}

// The profile files give the expected result above; names alone and the shape alone must agree with
// it.
TEST_F(RealFiles, AreRecognisedWithoutAnyDialectFile) {
  for (const Expected& expected : kExpected) {
    SCOPED_TRACE(expected.file);
    const Clip clip = load(expected.file);
    const auto map = recognise_skeleton(clip, {});
    if (!map) {
      ADD_FAILURE() << describe(map.error());
      continue;
    }
    const auto name = [&](const char* bone) { return joint_name(*map, clip.skeleton(), bone); };
    EXPECT_EQ(name("Hips"), expected.hips);
    EXPECT_EQ(name("Spine2"), expected.torso);
    EXPECT_EQ(name("LeftArm"), expected.arm);
    EXPECT_EQ(name("LeftUpLeg"), expected.thigh);
  }
}

TEST_F(RealFiles, AreRecognisedByShapeAlone) {
  for (const Expected& expected : kExpected) {
    SCOPED_TRACE(expected.file);
    const Clip clip = load(expected.file);
    const auto named = value_of(recognise_skeleton(clip, shipped_profiles()));
    const auto shaped = recognise_skeleton(without_names(clip), shipped_profiles());
    if (!shaped) {
      ADD_FAILURE() << describe(shaped.error());
      continue;
    }
    EXPECT_EQ(shaped->profile, "topology");
    for (const Bone bone : kMappedBones) {
      EXPECT_EQ(shaped->joint_of_bone[bone], named.joint_of_bone[bone]) << bone_name(bone);
    }
  }
}

TEST_F(RealFiles, HeadsetWithoutArmsNeedsPartial) {
  const Clip clip = load("dialects/slimevr_hmd_root.bvh");
  const auto refused = recognise_skeleton(clip, shipped_profiles());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  EXPECT_EQ(refused.error().message, "no arms found in the skeleton");
  EXPECT_NE(refused.error().hint.find(OPTION("partial")), std::string::npos);

  const auto map = value_of(recognise_skeleton(clip, shipped_profiles(), {.partial = true}));
  EXPECT_TRUE(map.partial);
  EXPECT_EQ(map.profile, "slimevr");
  const auto name = [&](const char* bone) { return joint_name(map, clip.skeleton(), bone); };
  EXPECT_EQ(name("Hips"), "Hip");
  EXPECT_EQ(name("Spine2"), "Chest");
  EXPECT_EQ(name("LeftUpLeg"), "Left-Hip");
  EXPECT_EQ(map.joint(Bone::kLeftArm), -1);
  // The tree runs from the head to the hips: the rotation of the chest is the neck joint's.
  const auto turned_by = [&](const char* bone) {
    return clip.skeleton()
        .joint(rotation_joint(map, clip.skeleton(), bone_from_name(bone).value()))
        .name;
  };
  EXPECT_EQ(turned_by("Spine2"), "Neck");
  EXPECT_EQ(turned_by("Hips"), "Hip");
  EXPECT_EQ(turned_by("LeftLeg"), "Left-Knee");
}

TEST_F(RealFiles, RejectsFilesThatAreNotHuman) {
  for (const char* file : {"dialects/nonhuman_dog.bvh", "dialects/full_precision_frame_time.bvh",
                           "dialects/rotation_first_root.bvh"}) {
    SCOPED_TRACE(file);
    const Clip clip = load(file);
    for (const bool partial : {false, true}) {
      const auto map = recognise_skeleton(clip, shipped_profiles(), {.partial = partial});
      ASSERT_FALSE(map);
      EXPECT_EQ(map.error().kind, ErrorKind::kInput);
      EXPECT_EQ(map.error().message.find('\n'), std::string::npos);
      EXPECT_FALSE(map.error().hint.empty());
    }
  }
}

TEST_F(RealFiles, RejectsDuplicateJointNames) {
  const Clip clip = load("quirks/28_duplicate_names.bvh");
  const auto map = recognise_skeleton(clip, shipped_profiles());
  ASSERT_FALSE(map);
  EXPECT_NE(map.error().message.find("\"LeftUpArm\""), std::string::npos) << map.error().message;
}

TEST_F(RealFiles, ConformanceFilesAreNotHuman) {
  for (const auto& entry : std::filesystem::directory_iterator(*folder_ / "bvh_conformance")) {
    if (entry.path().extension() != ".bvh") continue;
    const auto file = load_bvh(entry.path().string());
    if (!file) continue;
    EXPECT_FALSE(recognise_skeleton(file->clip, shipped_profiles(), {.partial = true}))
        << entry.path();
  }
}

}  // namespace
}  // namespace retarget
