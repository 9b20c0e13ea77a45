#include "motion/resample.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <vector>

namespace retarget {
namespace {

TimeScale slowed_in_the_middle() {
  TimeScale scale;
  scale.pace.assign(10, 1.0);
  for (const double pace : {1.2, 1.7, 2.0, 2.0, 1.5, 1.1}) scale.pace.push_back(pace);
  return scale;
}

TEST(TimeWarp, AConstantPaceStretchesUniformly) {
  TimeScale scale;
  scale.pace.assign(40, 1.25);
  const TimeWarp warp(scale, 3.0);
  EXPECT_NEAR(warp.duration(), 3.75, 1e-12);
  EXPECT_NEAR(warp.motion_time(1.3), 1.625, 1e-12);
  EXPECT_NEAR(warp.source_time(1.625), 1.3, 1e-12);
  EXPECT_EQ(warped_frame_count(scale, {30, 1}, 91), 113);
}

TEST(TimeWarp, OnlyAPaceThatIsTheSameEverywhereIsConstant) {
  TimeScale scale;
  EXPECT_EQ(constant_pace(std::nullopt), 1.0);
  EXPECT_EQ(constant_pace(scale), 1.0);
  scale.pace.assign(40, 1.25);
  EXPECT_EQ(constant_pace(scale), 1.25);
  EXPECT_EQ(constant_pace(slowed_in_the_middle()), 1.0);
}

TEST(TimeWarp, TimesAreInversesAndThePaceIsTheirDerivative) {
  const TimeWarp warp(slowed_in_the_middle(), 2.55);
  double before = -1.0;
  for (double time = 0.0; time <= 2.55; time += 0.01) {
    const double motion = warp.motion_time(time);
    EXPECT_GT(motion, before);
    before = motion;
    EXPECT_NEAR(warp.source_time(motion), time, 1e-12);
    if (time < 0.01 || time > 2.54) continue;
    constexpr double kSmall = 1e-5;
    const double slope =
        (warp.motion_time(time + kSmall) - warp.motion_time(time - kSmall)) / (2.0 * kSmall);
    EXPECT_NEAR(warp.pace(time), slope, 1e-8);
    EXPECT_GE(warp.pace(time), 1.0 - 1e-12);
    EXPECT_LE(warp.pace(time), 2.0);
  }
}

// Accelerations of the warp are continuous, and so is their rate.
TEST(TimeWarp, ThePaceHasNoCorners) {
  const TimeWarp warp(slowed_in_the_middle(), 2.5);
  constexpr double kSmall = 1e-4;
  const auto second = [&](double time) {
    return (warp.pace(time + kSmall) - 2.0 * warp.pace(time) + warp.pace(time - kSmall)) /
           (kSmall * kSmall);
  };
  for (int knot = 1; knot < 25; ++knot) {
    const double time = 0.1 * knot;
    EXPECT_NEAR(second(time - 2.0 * kSmall), second(time + 2.0 * kSmall), 1.0);
  }
}

TEST(TimeWarp, FramesBeforeAStretchStayExact) {
  auto frames = warped_frames(slowed_in_the_middle(), {30, 1}, 76);
  EXPECT_EQ(frames.size(),
            static_cast<std::size_t>(warped_frame_count(slowed_in_the_middle(), {30, 1}, 76)));
  EXPECT_GT(frames.size(), 80U);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(frames[static_cast<std::size_t>(i)].frame, i);
    EXPECT_EQ(frames[static_cast<std::size_t>(i)].share, 0.0);
  }
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const double step =
        frames[i].frame + frames[i].share - frames[i - 1].frame - frames[i - 1].share;
    EXPECT_GT(step, 0.49);
    EXPECT_LT(step, 1.0 + 1e-9);
  }
  EXPECT_LE(frames.back().frame, 75);
}

TEST(TimeWarp, AClipMovesSlower) {
  std::vector<Joint> joints(1);
  joints[0].name = "root";
  joints[0].channels = {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition};
  Clip clip(std::make_shared<const Skeleton>(joints), {60, 1}, 61);
  for (int i = 0; i < 61; ++i) clip.translations(i)[0] = {0.01 * i * i, 2.0 * i, 0.0};
  TimeScale scale;
  scale.pace.assign(20, 2.0);
  const Clip slow = warp_time(clip, scale);
  ASSERT_EQ(slow.frame_count(), 121);
  for (int i = 0; i < 121; ++i) {
    EXPECT_NEAR(slow.translations(i)[0].x(), 0.0025 * i * i, 1e-9);
    EXPECT_NEAR(slow.translations(i)[0].y(), i, 1e-9);
  }
  EXPECT_EQ(slow.rate(), clip.rate());
}

TEST(TimeWarp, HandlesShortClips) {
  TimeScale scale;
  scale.pace = {2.0, 2.0, 2.0, 2.0};
  EXPECT_EQ(warped_frame_count(scale, {30, 1}, 0), 0);
  EXPECT_EQ(warped_frame_count(scale, {30, 1}, 1), 1);
  EXPECT_EQ(warped_frame_count(scale, {30, 1}, 2), 3);
}

}  // namespace
}  // namespace retarget
