// Limbs whose rotations do not match their bends.
#include "human/skeleton/limb_directions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "formats/bvh/read_bvh.h"
#include "human/doubts.h"
#include "human/hand_made_maps.h"
#include "human/rest_twins.h"
#include "human/skeleton/calibrate.h"
#include "retarget/plan.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/value_of.h"

namespace retarget {
namespace {

const std::vector<std::string> kClips = {"get_up", "squat", "turn_in_place", "walk", "wave"};

double largest_distance(const HumanClip& a, const HumanClip& b) {
  double largest = 0.0;
  for (int frame = 0; frame < a.frame_count; ++frame) {
    for (const Bone bone : kAllBones) {
      const Eigen::Vector3d apart =
          a.frame(frame)[bone].translation - b.frame(frame)[bone].translation;
      largest = std::max(largest, apart.norm());
    }
  }
  return largest;
}

TEST(LimbTwists, ReplacesRotationsThatContradictTheBends) {
  const std::vector<Bone> legs = {Bone::kLeftUpLeg, Bone::kRightUpLeg, Bone::kLeftLeg,
                                  Bone::kRightLeg};
  for (const char* name : {"get_up", "squat", "walk"}) {
    SCOPED_TRACE(name);
    const Clip clip = recorded_clip(name);
    const HumanClip expected = lafan1_human(clip);
    Clip twin = with_zero_shape(with_swinging_twists(clip, 50.0), {});
    const BoneMap map = lafan1_map(twin.skeleton(), "test");
    const Calibration found = calibrate(twin, map, {}).value();
    const HumanClip before = to_human(twin, found);
    EXPECT_GT(mean_turn(before, expected, legs), 25.0);
    const auto doubt = let_bends_win(twin, map, found).value();
    EXPECT_THAT(doubt.message, testing::HasSubstr("left leg, right leg"));
    const HumanClip after = to_human(twin, found);
    EXPECT_LT(mean_turn(after, expected, legs), 6.0);
    // Nothing else changes.
    EXPECT_LT(largest_distance(after, before), 1e-9);
    EXPECT_LT(mean_turn(after, before,
                        {Bone::kHips, Bone::kLeftFootMod, Bone::kRightFootMod, Bone::kLeftHand,
                         Bone::kRightHand}),
              1e-5);
  }
}

TEST(LimbTwists, KeepsConsistentRotations) {
  for (const std::string& name : kClips) {
    for (const bool has_rest : {false, true}) {
      const Clip clip = has_rest ? with_t_pose_as_zero(recorded_clip(name)) : recorded_clip(name);
      Clip changed = clip;
      const BoneMap map = lafan1_map(clip.skeleton(), "test");
      EXPECT_FALSE(let_bends_win(changed, map, calibrate(clip, map, {}).value())) << name;
      for (int frame = 0; frame < clip.frame_count(); ++frame) {
        ASSERT_TRUE(std::ranges::equal(
            clip.rotations(frame), changed.rotations(frame),
            [](const auto& a, const auto& b) { return a.coeffs() == b.coeffs(); }));
      }
    }
  }
}

// As the tool finds a human in a file.
TEST(LimbTwists, AreReported) {
  Clip clip = with_zero_shape(with_swinging_twists(recorded_clip("walk"), 50.0), {});
  const auto human = value_of(find_human(clip, HumanOptions{}, RETARGET_SOURCE_DIR));
  EXPECT_TRUE(has_doubt(human.calibration, "knees and elbows do not bend about fixed axes"));
}

}  // namespace
}  // namespace retarget
