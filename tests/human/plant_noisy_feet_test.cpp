#include "human/gait/plant_noisy_feet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "human/gait/noisy_stances.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kFrameTime = 1.0 / 30.0;

// Two feet standing side by side; their tracks can be changed afterwards.
SourceFeet feet_in_place(int frames) {
  SourceFeet feet;
  feet.frame_time = kFrameTime;
  feet.foot_count = 2;
  for (int i = 0; i < frames; ++i) {
    for (int foot = 0; foot < 2; ++foot) {
      SourceFoot one;
      one.ankle = Vector3d(0.0, 0.2 * foot, 0.08);
      one.toe = Vector3d(0.15, 0.2 * foot, 0.02);
      feet.feet.push_back(one);
    }
    feet.hips.push_back(0.9);
  }
  return feet;
}

void shift(SourceFeet& feet, int frame, int foot, const Vector3d& by) {
  SourceFoot& one = feet.feet[static_cast<std::size_t>(2 * frame + foot)];
  one.ankle += by;
  one.toe += by;
}

int standing_frames(const std::vector<char>& stands) {
  return static_cast<int>(std::ranges::count(stands, 1));
}

TEST(NoisyStances, NoisePeaksDoNotSplitStances) {
  SourceFeet feet = feet_in_place(60);
  // 0.9 m/s for two frames: faster than any threshold for single frames.
  shift(feet, 30, 0, Vector3d(0.06, 0.0, 0.0));
  const NoisyStances stances = find_noisy_stances(feet, 0.1);
  for (const auto& end : stances) EXPECT_EQ(standing_frames(end), 60);
}

TEST(NoisyStances, FindsSteps) {
  SourceFeet feet = feet_in_place(60);
  for (int i = 0; i < 60; ++i) {
    const double share = std::clamp((i - 25) / 12.0, 0.0, 1.0);
    shift(feet, i, 1, Vector3d(0.6 * share, 0.0, 0.4 * share * (1.0 - share)));
  }
  const NoisyStances stances = find_noisy_stances(feet, 0.1);
  for (const int end : {kHeelEnd, kToeEnd}) {
    EXPECT_EQ(standing_frames(stances[stance_index(0, end)]), 60);
    const auto& stepping = stances[stance_index(1, end)];
    EXPECT_EQ(stepping[31], 0);
    EXPECT_NEAR(standing_frames(stepping), 48, 4);
    EXPECT_EQ(stepping.front(), 1);
    EXPECT_EQ(stepping.back(), 1);
  }
}

TEST(NoisyStances, ExcludeFeetAboveTheFloor) {
  SourceFeet feet = feet_in_place(90);
  for (int i = 40; i < 60; ++i) shift(feet, i, 0, Vector3d(0.0, 0.0, 0.3));
  const NoisyStances stances = find_noisy_stances(feet, 0.1);
  EXPECT_EQ(stances[stance_index(0, kToeEnd)][50], 0);
  EXPECT_EQ(stances[stance_index(1, kToeEnd)][50], 1);
}

// Both feet are slightly too fast; an upright person stands on one of them.
TEST(NoisyStances, UprightBodiesAreSupported) {
  const auto sliding = [](double hips) {
    SourceFeet feet = feet_in_place(120);
    for (int i = 0; i < 120; ++i) {
      const double way = 0.45 * kFrameTime * std::clamp(i - 40, 0, 40);
      for (int foot = 0; foot < 2; ++foot) shift(feet, i, foot, Vector3d(way, 0.0, 0.0));
      feet.hips[static_cast<std::size_t>(i)] = hips;
    }
    return find_noisy_stances(feet, 0.1);
  };
  const NoisyStances upright = sliding(0.9), lying = sliding(0.1);
  EXPECT_TRUE(std::ranges::any_of(upright, [](const auto& end) { return end[60] == 1; }));
  EXPECT_TRUE(std::ranges::none_of(lying, [](const auto& end) { return end[60] == 1; }));
}

}  // namespace
}  // namespace retarget
