
#include <gtest/gtest.h>

#include "formats/bvh/read_bvh.h"
#include "retarget/bvh.h"
#include "retarget/edit.h"
#include "retarget/human.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/value_of.h"

namespace retarget {
namespace {

// The human survives a round trip through LAFAN1's layout.
TEST(Lafan1Clip, RoundTripsTheHuman) {
  for (const char* name : {"walk", "get_up"}) {
    const Clip clip = recorded_clip(name);
    const Calibration calibration = lafan1_calibration(clip.skeleton());
    const HumanClip human = to_human(clip, calibration);
    const auto shaped = value_of(lafan1_clip(clip, calibration));
    const Clip read = read_bvh(format_bvh(shaped).value(), name).value().clip;
    const HumanClip again = lafan1_human(read);
    for (int frame = 0; frame < human.frame_count; ++frame) {
      for (const Bone bone : kAllBones) {
        const Pose &a = human.frame(frame)[bone], &b = again.frame(frame)[bone];
        ASSERT_LT((a.translation - b.translation).norm(), 1e-9) << name;
        ASSERT_GT(std::abs(a.rotation.dot(b.rotation)), 1.0 - 1e-12) << name;
      }
    }
  }
}

TEST(Lafan1Clip, ScalesBodiesToOneSize) {
  const Clip clip = recorded_clip("walk");
  Calibration calibration = lafan1_calibration(clip.skeleton());
  const Clip expected = lafan1_clip(clip, calibration).value();
  // A child with the same movement.
  calibration.size *= 0.5;
  calibration.metres_per_unit *= 0.5;
  const Clip child = lafan1_clip(clip, calibration).value();
  for (int joint = 0; joint < expected.skeleton().joint_count(); ++joint) {
    EXPECT_LT(
        (child.skeleton().joint(joint).offset - expected.skeleton().joint(joint).offset).norm(),
        1e-9);
  }
  EXPECT_LT((child.translation(10, 0) - expected.translation(10, 0)).norm(), 1e-9);
}

TEST(Lafan1Clip, FillsMissingBonesExceptLimbs) {
  const Clip clip = recorded_clip("walk");
  Calibration calibration = lafan1_calibration(clip.skeleton());
  calibration.bones[Bone::kNeck] = {};
  calibration.bones[Bone::kLeftToe] = {};
  const auto shaped = value_of(lafan1_clip(clip, calibration));
  EXPECT_EQ(shaped.skeleton().joint_count(), 22);
  EXPECT_EQ(shaped.skeleton().joint(4).offset.norm(), 0.0);
  calibration.bones[Bone::kLeftArm] = {};
  const auto armless = lafan1_clip(clip, calibration);
  ASSERT_FALSE(armless);
  EXPECT_NE(armless.error().message.find("LeftArm"), std::string::npos);
}

}  // namespace
}  // namespace retarget
