#include "edit/lafan1_clip.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "bvh/read_bvh.h"
#include "bvh/write_bvh.h"

namespace retarget {
namespace {

Clip sample(const std::string& name) {
  const std::filesystem::path data = std::filesystem::path(RETARGET_SOURCE_DIR) / "data";
  return load_bvh((data / (name + ".bvh")).string()).value().clip;
}

// written and read as LAFAN1, the human is the same
TEST(Lafan1Clip, OfAHumanGivesThatHumanBack) {
  for (const char* name : {"walk", "get_up"}) {
    const Clip clip = sample(name);
    const HumanClip human = to_human(clip, lafan1_mapping(clip.skeleton(), name).value());
    const auto shaped = lafan1_clip(human, name);
    ASSERT_TRUE(shaped) << describe(shaped.error());
    const Clip read = read_bvh(format_bvh(*shaped).value(), name).value().clip;
    const HumanClip again = to_human(read, lafan1_mapping(read.skeleton(), name).value());
    for (int frame = 0; frame < human.frame_count; ++frame) {
      for (const Bone bone : kAllBones) {
        const Pose &a = human.frame(frame)[bone], &b = again.frame(frame)[bone];
        ASSERT_LT((a.translation - b.translation).norm(), 1e-9) << name;
        ASSERT_GT(std::abs(a.rotation.dot(b.rotation)), 1.0 - 1e-12) << name;
      }
    }
  }
}

TEST(Lafan1Clip, BringsBodiesToOneSize) {
  const Clip clip = sample("walk");
  HumanClip human = to_human(clip, lafan1_mapping(clip.skeleton(), "walk").value());
  const Clip expected = lafan1_clip(human, "walk").value();
  // a child that moves alike
  human.size *= 0.5;
  for (HumanPose& frame : human.world_from_bone) {
    for (Pose& pose : frame) pose.translation *= 0.5;
  }
  const Clip child = lafan1_clip(human, "walk").value();
  for (int joint = 0; joint < expected.skeleton().joint_count(); ++joint) {
    EXPECT_LT(
        (child.skeleton().joint(joint).offset - expected.skeleton().joint(joint).offset).norm(),
        1e-9);
  }
  EXPECT_LT((child.translation(10, 0) - expected.translation(10, 0)).norm(), 1e-9);
}

TEST(Lafan1Clip, FillsWhatIsMissingButLimbs) {
  const Clip clip = sample("walk");
  HumanClip human = to_human(clip, lafan1_mapping(clip.skeleton(), "walk").value());
  human.sources[Bone::kNeck].clear();
  human.sources[Bone::kLeftToe].clear();
  const auto shaped = lafan1_clip(human, "walk");
  ASSERT_TRUE(shaped);
  EXPECT_EQ(shaped->skeleton().joint_count(), 22);
  EXPECT_EQ(shaped->skeleton().joint(4).offset.norm(), 0.0);
  human.sources[Bone::kLeftArm].clear();
  const auto armless = lafan1_clip(human, "walk");
  ASSERT_FALSE(armless);
  EXPECT_NE(armless.error().message.find("LeftArm"), std::string::npos);
}

}  // namespace
}  // namespace retarget
