#include "retarget/clip_range.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "motion/lost_end.h"
#include "motion/test_clips.h"
#include "retarget/clip.h"

namespace retarget {
namespace {

// Swings at 1 Hz, slowly enough for any rate.
Clip swinging(double fps, int frames) {
  return make_clip({static_cast<std::int64_t>(fps), 1}, frames,
                   [](double t) { return 0.5 * std::sin(2.0 * M_PI * t); });
}

// Prepends `count` frames in which every joint is rotated by `angle`.
Clip with_frames_in_front(const Clip& clip, int count, double angle) {
  Clip longer(clip.shared_skeleton(), clip.rate(), clip.frame_count() + count);
  for (int frame = 0; frame < longer.frame_count(); ++frame) {
    copy_frame(clip, std::max(0, frame - count), longer, frame);
    if (frame >= count) continue;
    for (auto& rotation : longer.rotations(frame)) rotation = exp_so3(angle * kTestAxis);
  }
  return longer;
}

TEST(LeadIn, PlainMotionsHaveNone) {
  for (const double fps : {24.0, 30.0, 120.0})
    EXPECT_EQ(count_lead_in_frames(swinging(fps, 90)), 0);
  EXPECT_EQ(count_lead_in_frames(swinging(30, 0)), 0);
  EXPECT_EQ(count_lead_in_frames(swinging(30, 1)), 0);
  EXPECT_EQ(count_lead_in_frames(swinging(30, 3)), 0);
}

TEST(LeadIn, FindsAFrameThatTheMotionJumpsAwayFrom) {
  for (const double fps : {24.0, 30.0, 120.0}) {
    EXPECT_EQ(count_lead_in_frames(with_frames_in_front(swinging(fps, 90), 1, 2.0)), 1) << fps;
  }
}

TEST(LeadIn, FindsALeadingZeroFrame) {
  // Too short to determine the character of its motion.
  const Clip clip = make_clip({30, 1}, 2, [](double) { return 1.5; });
  EXPECT_EQ(count_lead_in_frames(with_frames_in_front(clip, 1, 0.0)), 1);
  EXPECT_EQ(count_lead_in_frames(with_frames_in_front(clip, 1, 0.2)), 0);
}

TEST(LeadIn, FindsAHeldPose) {
  EXPECT_EQ(count_lead_in_frames(with_frames_in_front(swinging(30, 90), 12, 2.0)), 12);
}

// Appends `count` frames in which every joint is rotated by `angle`.
Clip with_frames_behind(const Clip& clip, int count, double angle) {
  Clip longer(clip.shared_skeleton(), clip.rate(), clip.frame_count() + count);
  for (int frame = 0; frame < longer.frame_count(); ++frame) {
    copy_frame(clip, std::min(clip.frame_count() - 1, frame), longer, frame);
    if (frame < clip.frame_count()) continue;
    for (auto& rotation : longer.rotations(frame)) rotation = exp_so3(angle * kTestAxis);
  }
  return longer;
}

TEST(LostEnd, FindsFramesOfZerosAfterAJump) {
  const Clip turned = make_clip({30, 1}, 90, [](double t) { return 1.5 + 0.1 * t; });
  for (const int count : {1, 3, 40}) {
    EXPECT_EQ(count_lost_end_frames(with_frames_behind(turned, count, 0.0)), count);
    EXPECT_EQ(count_lost_end_frames(with_frames_behind(turned, count, 0.2)), 0);
  }
}

TEST(LostEnd, MotionsThatEndWithoutAJumpHaveNone) {
  for (const int frames : {0, 1, 3, 90}) EXPECT_EQ(count_lost_end_frames(swinging(30, frames)), 0);
  // A movement that slows down to the rest pose.
  const Clip slowing = make_clip({30, 1}, 90, [](double t) { return std::max(0.0, 1.5 - t); });
  EXPECT_EQ(count_lost_end_frames(slowing), 0);
  const Clip still = make_clip({30, 1}, 90, [](double) { return 0.0; });
  EXPECT_EQ(count_lost_end_frames(still), 0);
}

// A helper at the origin, above a body that stands 30 m away.
TEST(LeadIn, IgnoresAHelperAboveTheBody) {
  const Clip clip = with_frames_in_front(swinging(30, 90), 12, 2.0);
  std::vector<Joint> joints = {make_joint("Reference", -1, Eigen::Vector3d::Zero())};
  for (Joint joint : clip.skeleton().joints()) {
    ++joint.parent;
    joints.push_back(std::move(joint));
  }
  Clip below(std::make_shared<const Skeleton>(joints), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    std::ranges::copy(clip.rotations(frame), below.rotations(frame).begin() + 1);
    std::ranges::copy(clip.translations(frame), below.translations(frame).begin());
    below.translations(frame)[0].x() += 30.0;
  }
  EXPECT_EQ(count_lead_in_frames(below), 12);
}

TEST(LeadIn, ToleratesNoiseInAHeldPose) {
  Clip clip = with_frames_in_front(swinging(120, 360), 240, 2.0);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.005);
  for (int frame = 0; frame < 240; ++frame) {
    for (auto& rotation : clip.rotations(frame)) {
      rotation = rotation * exp_so3(Eigen::Vector3d(noise(random), noise(random), noise(random)));
    }
  }
  EXPECT_EQ(count_lead_in_frames(clip), 240);
}

TEST(LeadIn, StandingBeforeAGlitchIsMotion) {
  // Stands, sways a little, and one frame in between is garbage.
  Clip clip = make_clip({30, 1}, 240, [](double t) { return 0.005 * std::sin(2.0 * t); });
  for (auto& rotation : clip.rotations(100)) rotation = exp_so3(2.0 * kTestAxis);
  EXPECT_EQ(count_lead_in_frames(clip), 0);
  // Alternatively, the body jumps to another location and remains there.
  Clip moved = make_clip({30, 1}, 240, [](double t) { return 0.005 * std::sin(2.0 * t); });
  for (int frame = 100; frame < moved.frame_count(); ++frame) {
    moved.translations(frame)[0] += Eigen::Vector3d(3.0, 0.0, 0.0);
  }
  EXPECT_EQ(count_lead_in_frames(moved), 0);
}

TEST(LeadIn, FindsSeveralPoses) {
  const Clip posed = with_frames_in_front(swinging(30, 90), 5, 2.0);
  EXPECT_EQ(count_lead_in_frames(with_frames_in_front(posed, 1, -1.0)), 6);
}

TEST(LeadIn, StillPoseWithoutAJumpIsPartOfTheMotion) {
  const Clip clip = make_clip({30, 1}, 120, [](double t) {
    return t < 1.0 ? 0.0 : 0.5 * (1.0 - std::cos(2.0 * M_PI * (t - 1.0)));
  });
  EXPECT_EQ(count_lead_in_frames(clip), 0);
}

TEST(LeadIn, MovementBeforeTheJumpIsMotion) {
  Clip clip = swinging(30, 90);
  for (int frame = 20; frame < clip.frame_count(); ++frame) {
    for (auto& rotation : clip.rotations(frame)) rotation = exp_so3(2.0 * kTestAxis) * rotation;
  }
  EXPECT_EQ(count_lead_in_frames(clip), 0);
}

TEST(LeadIn, MotionThatAlwaysJumpsHasNone) {
  Clip clip = swinging(30, 90);
  for (int frame = 0; frame < clip.frame_count(); frame += 3) {
    for (auto& rotation : clip.rotations(frame)) rotation = exp_so3(1.0 * kTestAxis) * rotation;
  }
  EXPECT_EQ(count_lead_in_frames(clip), 0);
}

}  // namespace
}  // namespace retarget
