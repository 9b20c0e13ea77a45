// The share of the speed of fast limbs that a robot preserves, on limbs that swing like pendulums.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "judge/quality/similarity_metrics.h"

namespace retarget {
namespace {

constexpr double kAmplitude = 0.5, kHertz = 1.0;  // Largest speed: 3.1 rad/s.

// A limb of a human that swings in a plane, and that of a robot with a share of the amplitude.
LimbDirections pendulum(double share, double fps, double seconds = 10.0) {
  LimbDirections limb;
  limb.rank = 1;
  for (int frame = 0; frame < static_cast<int>(seconds * fps); ++frame) {
    const double angle = kAmplitude * std::sin(2.0 * std::numbers::pi * kHertz * frame / fps);
    limb.human.emplace_back(0.4 * std::cos(angle), 0.4 * std::sin(angle), 0.0);
    limb.robot.emplace_back(std::cos(share * angle), 0.0, std::sin(share * angle));
  }
  return limb;
}

TEST(FastLimbs, PreserveTheRatioOfSpeeds) {
  for (const double fps : {30.0, 60.0, 120.0}) {
    const LimbDirections half = pendulum(0.5, fps), whole = pendulum(1.0, fps);
    EXPECT_NEAR(fast_speed_kept(std::array{half}, false, fps).value(), 0.5, 1e-9) << fps;
    EXPECT_NEAR(fast_speed_kept(std::array{half, whole}, false, fps).value(), 0.75, 1e-9) << fps;
    // Legs and the lines of the trunk do not count among arms.
    LimbDirections leg = whole, line = whole;
    leg.of_legs = true;
    line.rank = 0;
    const std::array all{half, leg, line};
    EXPECT_NEAR(fast_speed_kept(all, false, fps).value(), 0.5, 1e-9) << fps;
    EXPECT_NEAR(fast_speed_kept(all, true, fps).value(), 1.0, 1e-9) << fps;
  }
}

TEST(FastLimbs, TheSlowerSideCounts) {
  const auto both = [](double left, double right, double seconds) {
    std::array limbs{pendulum(left, 30.0, seconds), pendulum(right, 30.0, seconds)};
    limbs[0].side = Side::kLeft;
    limbs[1].side = Side::kRight;
    return fast_speed_kept(limbs, false, 30.0).value();
  };
  EXPECT_NEAR(both(1.0, 0.1, 10.0), 0.1, 1e-9);
  EXPECT_NEAR(both(0.1, 1.0, 10.0), 0.1, 1e-9);
  // Four fast frames of one side are fewer than 0.2 s, so that both sides count together.
  EXPECT_NEAR(both(0.1, 0.3, 6.0), 0.2, 1e-9);
}

TEST(FastLimbs, AreMeasuredWhereTheHumanIsFast) {
  // The robot stops where the human is slowest.
  LimbDirections limb = pendulum(1.0, 30.0);
  for (std::size_t i = 6; i < limb.robot.size(); i += 15) {
    limb.robot[i] = limb.robot[i + 1] = limb.robot[i + 2] = limb.robot[i + 3];
  }
  EXPECT_NEAR(fast_speed_kept(std::array{limb}, false, 30.0).value(), 1.0, 1e-9);
}

TEST(FastLimbs, ExcludeFramesNearTheFloor) {
  LimbDirections limb = pendulum(1.0, 30.0);
  const LimbDirections slower = pendulum(0.4, 30.0);
  limb.free.assign(limb.human.size(), 1);
  for (std::size_t i = 0; i < limb.human.size() / 2; ++i) {
    limb.robot[i] = slower.robot[i];
    limb.free[i] = 0;
  }
  EXPECT_NEAR(fast_speed_kept(std::array{limb}, false, 30.0).value(), 1.0, 1e-9);
}

TEST(FastLimbs, NeedASecondAndSpeed) {
  EXPECT_FALSE(fast_speed_kept({}, false, 30.0));
  EXPECT_FALSE(fast_speed_kept(std::array{pendulum(1.0, 30.0, 0.9)}, false, 30.0));
  LimbDirections slow = pendulum(1.0, 30.0);
  for (std::size_t i = 0; i < slow.human.size(); ++i) {
    const double angle =
        0.3 * std::sin(2.0 * std::numbers::pi * kHertz * static_cast<double>(i) / 30.0);
    slow.human[i] = {std::cos(angle), std::sin(angle), 0.0};
  }
  EXPECT_FALSE(fast_speed_kept(std::array{slow}, false, 30.0));
  // Two fast frames of one limb are fewer than 0.1 s; of two limbs, they are enough.
  const LimbDirections brief = pendulum(1.0, 30.0, 3.3);
  EXPECT_FALSE(fast_speed_kept(std::array{brief}, false, 30.0));
  EXPECT_TRUE(fast_speed_kept(std::array{brief, brief}, false, 30.0));
}

}  // namespace
}  // namespace retarget
