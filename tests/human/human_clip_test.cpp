#include "retarget/human.h"

#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

#include "retarget/human_poser.h"
#include "support/lafan1_map.h"

namespace retarget {
namespace {

Joint joint(const std::string& name, int parent, Eigen::Vector3d offset) {
  Joint result;
  result.name = name;
  result.parent = parent;
  result.offset = offset;
  return result;
}

// A poser refers to its arguments.
static_assert(std::is_constructible_v<HumanPoser, const Clip&, const Calibration&>);
static_assert(!std::is_constructible_v<HumanPoser, const Clip&, Calibration>);
static_assert(!std::is_constructible_v<HumanPoser, Clip, const Calibration&>);

// A leg that stands on a platform, in centimetres with y up.
Clip leg_clip(const std::string& toe) {
  auto skeleton = std::make_shared<const Skeleton>(
      std::vector<Joint>{joint("Reference", -1, {10, 0, 0}), joint("Hips", 0, {0, 90, 5}),
                         joint("LeftUpLeg", 1, {0, 0, 10}), joint("LeftLeg", 2, {0, -45, 0}),
                         joint("LeftFoot", 3, {0, -40, 0}), joint(toe, 4, {15, 0, 0})});
  Clip clip(skeleton, {30, 1}, 2);
  const double half = std::sqrt(0.5);
  clip.rotations(1)[5] = Eigen::Quaterniond(half, 0, half, 0);  // the toe, a quarter turn about y
  return clip;
}

TEST(Lafan1Mapping, ConvertsYUpCentimetresToZUpMetres) {
  const Clip clip = leg_clip("LeftToe");
  const HumanClip human = lafan1_human(clip);
  EXPECT_EQ(human.frame_count, 2);
  EXPECT_EQ(human.height, 1.75);
  const Pose& foot = human.frame(0)[Bone::kLeftFoot];
  // (10, 5, 15) with y up.
  EXPECT_LT((foot.translation - Eigen::Vector3d(0.10, -0.15, 0.05)).norm(), 1e-15);
  // A direction along y in the file is along z in the clip.
  EXPECT_LT((foot.rotation * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
  EXPECT_LT((foot.rotation * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitX()).norm(), 1e-15);
}

TEST(Lafan1Mapping, SyntheticFootHasAnklePositionAndToeRotation) {
  for (const char* toe : {"LeftToe", "LeftToeBase"}) {
    const Clip clip = leg_clip(toe);
    const HumanClip human = lafan1_human(clip);
    const Pose& mod = human.frame(1)[Bone::kLeftFootMod];
    EXPECT_EQ(mod.translation, human.frame(1)[Bone::kLeftFoot].translation);
    EXPECT_EQ(mod.rotation.coeffs(), human.frame(1)[Bone::kLeftToe].rotation.coeffs());
    // The toe is rotated about the file's y axis, which is now z.
    const Eigen::Vector3d x = mod.rotation * Eigen::Vector3d::UnitX();
    EXPECT_LT((x - Eigen::Vector3d(0, 1, 0)).norm(), 1e-15);
  }
}

TEST(Lafan1Mapping, OmitsMissingBones) {
  const Clip clip = leg_clip("Ball");
  const HumanClip human = lafan1_human(clip);
  EXPECT_TRUE(human.has(Bone::kLeftFoot));
  EXPECT_EQ(human.sources[Bone::kLeftFoot], "LeftFoot");
  EXPECT_FALSE(human.has(Bone::kLeftToe));
  EXPECT_FALSE(human.has(Bone::kLeftFootMod));
  EXPECT_FALSE(human.has(Bone::kRightArm));
}

TEST(Bone, FindsByName) {
  ASSERT_EQ(bone_names().size(), kBoneCount);
  for (const Bone bone : kAllBones) {
    EXPECT_EQ(bone_names()[static_cast<std::size_t>(bone)], bone_name(bone));
    EXPECT_EQ(bone_from_name(bone_name(bone)), bone);
  }
  EXPECT_EQ(bone_from_name("LeftToeBase"), Bone::kLeftToe);
  EXPECT_EQ(bone_name(Bone::kRightHand), "RightHand");
  EXPECT_EQ(mapped_bone_names().back(), "RightHand");
  EXPECT_FALSE(bone_from_name("hips"));
}

TEST(Bone, SidesMatchNames) {
  for (const Bone bone : kAllBones) {
    const std::string name(bone_name(bone));
    const Side side = name.starts_with("Left")    ? Side::kLeft
                      : name.starts_with("Right") ? Side::kRight
                                                  : Side::kNone;
    EXPECT_EQ(side_of(bone), side) << name;
    EXPECT_EQ(mirrored(mirrored(bone)), bone) << name;
    const auto part = limb_bone(bone);
    ASSERT_EQ(part.has_value(), side != Side::kNone) << name;
    if (side == Side::kLeft) {
      EXPECT_EQ(bone_name(mirrored(bone)), "Right" + name.substr(4));
    } else if (side == Side::kNone) {
      EXPECT_EQ(mirrored(bone), bone) << name;
    }
    if (part) {
      EXPECT_EQ(side_bone(side, *part), bone) << name;
    }
  }
}

}  // namespace
}  // namespace retarget
