#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "judge/quality/similarity_metrics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// A vertical oscillation, metres, with a slow and a fast horizontal one.
std::vector<Vector3d> track(double hertz, double amplitude, double fps = 30.0, int frames = 300) {
  std::vector<Vector3d> points;
  for (int i = 0; i < frames; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / fps;
    points.emplace_back(std::sin(0.2 * turn), 0.1 * std::sin(5.0 * turn),
                        1.0 + amplitude * std::sin(hertz * turn));
  }
  return points;
}

TEST(RootBounce, IsTheRatioOfAmplitudes) {
  for (const double fps : {30.0, 60.0, 120.0}) {
    const int frames = static_cast<int>(10 * fps);
    const auto kept =
        bounce_kept(track(4.5, 0.01, fps, frames), track(4.5, 0.02, fps, frames), fps);
    ASSERT_TRUE(kept) << fps;
    EXPECT_NEAR(*kept, 0.5, 1e-3) << fps;
  }
}

TEST(RootBounce, IgnoresSlowAndHorizontalMovement) {
  std::vector<Vector3d> found = track(4.5, 0.02);
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i].z() += 0.05 * std::sin(2.0 * std::numbers::pi * 0.5 * static_cast<double>(i) / 30.0);
    found[i].x() *= 2.0;
  }
  EXPECT_NEAR(*bounce_kept(found, track(4.5, 0.02), 30.0), 1.0, 0.02);
}

TEST(RootBounce, IsOneWithoutFastMovement) {
  EXPECT_EQ(bounce_kept(track(1.0, 0.01), track(1.0, 0.02), 30.0), 1.0);
  EXPECT_EQ(bounce_kept(track(4.5, 0.0), track(4.5, 0.001), 30.0), 1.0);
}

TEST(RootBounce, NeedsASecondAndTwentyFrames) {
  EXPECT_FALSE(bounce_kept(track(4.5, 0.02, 30.0, 29), track(4.5, 0.02, 30.0, 29), 30.0));
  EXPECT_TRUE(bounce_kept(track(4.5, 0.02, 30.0, 31), track(4.5, 0.02, 30.0, 31), 30.0));
  EXPECT_FALSE(bounce_kept(track(4.5, 0.02, 15.0, 300), track(4.5, 0.02, 15.0, 300), 15.0));
}

}  // namespace
}  // namespace retarget
