#include "human/gait/centred_root.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "retarget/human_poser.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"

namespace retarget {
namespace {

std::vector<double> hip_heights(const Clip& clip) {
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  HumanPoser poser(clip, calibration);
  std::vector<double> heights;
  HumanPose pose;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    poser.pose(frame, pose);
    heights.push_back(pose[Bone::kHips].translation.z());
  }
  return heights;
}

std::optional<double> restore(Clip& clip) {
  return restore_centred_height(clip, {0, clip.frame_count()}, lafan1_calibration(clip.skeleton()));
}

TEST(CentredRoot, OfASquatGetsItsHeight) {
  Clip clip = recorded_clip("squat");
  const std::vector<double> recorded = hip_heights(clip);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0] = Eigen::Vector3d::Zero();
  }
  const auto moved = restore(clip);
  ASSERT_TRUE(moved);
  EXPECT_GT(*moved, 0.3);
  const std::vector<double> restored = hip_heights(clip);
  std::vector<double> errors;
  for (std::size_t i = 0; i < restored.size(); ++i) errors.push_back(restored[i] - recorded[i]);
  const auto [low, high] = std::ranges::minmax(errors);
  EXPECT_LT(high - low, 0.04);
  // The feet are on the floor.
  EXPECT_LT(std::max(-low, high), 0.04);
}

TEST(CentredRoot, RecordedHipsMove) {
  for (const char* name : {"walk", "squat", "wave", "get_up", "turn_in_place"}) {
    Clip clip = recorded_clip(name);
    const std::vector<double> recorded = hip_heights(clip);
    EXPECT_FALSE(restore(clip)) << name;
    EXPECT_EQ(hip_heights(clip), recorded) << name;
  }
}

// A body that stands still for most of the clip, and then moves.
TEST(CentredRoot, RecordedHipsMoveAfterALongPause) {
  for (const char* name : {"walk", "squat"}) {
    const Clip moving = recorded_clip(name);
    const int still = 12 * moving.frame_count();
    Clip clip(moving.shared_skeleton(), moving.rate(), still + moving.frame_count());
    clip.set_origin(moving.origin());
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      const int from = std::max(0, frame - still);
      std::ranges::copy(moving.rotations(from), clip.rotations(frame).begin());
      std::ranges::copy(moving.translations(from), clip.translations(frame).begin());
    }
    EXPECT_FALSE(restore(clip)) << name;
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      clip.translations(frame)[0] = Eigen::Vector3d::Zero();
    }
    EXPECT_TRUE(restore(clip)) << name;
  }
}

}  // namespace
}  // namespace retarget
