// The shift of the centre of mass against the closed form of the linear inverted pendulum.

#include "judge/simulation/reference_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace retarget {
namespace {

using Eigen::Vector2d;

const std::vector<Vector2d> kSquare = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

TEST(BalancePreview, NearestPointOfSupport) {
  EXPECT_EQ(nearest_in_support({0.3, -0.2}, kSquare, 1.0), Vector2d(0.3, -0.2));
  EXPECT_LT((nearest_in_support({3.0, 0.5}, kSquare, 1.0) - Vector2d(1.0, 0.5)).norm(), 1e-15);
  EXPECT_LT((nearest_in_support({3.0, 3.0}, kSquare, 0.5) - Vector2d(0.5, 0.5)).norm(), 1e-15);
  EXPECT_EQ(nearest_in_support({3.0, 3.0}, {{1.0, 2.0}}, 1.0), Vector2d(1.0, 2.0));
  EXPECT_LT((nearest_in_support({0.0, 1.0}, {{-1.0, 0.0}, {1.0, 0.0}}, 1.0)).norm(), 1e-15);
  EXPECT_EQ(nearest_in_support({3.0, 3.0}, {}, 1.0), Vector2d(3.0, 3.0));
}

TEST(BalancePreview, DoesNotChangeABalancedMotion) {
  const std::vector<BalanceSample> samples(100, {{0.2, 0.1}, kSquare, 10.0});
  for (const Vector2d& shift : balancing_shift(samples, 0.01, 0.8)) EXPECT_EQ(shift.norm(), 0.0);
}

// The zero-moment point leaves the support by d at time T. The bounded solution of
// x'' = w^2 (x + d [t > T]) is -d/2 exp(w (t - T)) before T and -d (1 - exp(-w (t - T)) / 2) after.
TEST(BalancePreview, LeansBeforeItHasTo) {
  constexpr double kStep = 0.001, kPull = 12.0, kBeyond = 0.05;
  constexpr int kCount = 16000, kChange = 8000;
  std::vector<BalanceSample> samples(kCount);
  for (int i = 0; i < kCount; ++i) {
    samples[i] = {{i > kChange ? 1.0 + kBeyond : 0.5, 0.0}, kSquare, kPull};
  }
  const auto shift = balancing_shift(samples, kStep, 1.0);
  const double w = std::sqrt(kPull);
  for (int i = kChange - 1000; i < kChange + 1000; i += 50) {
    const double t = kStep * (i - kChange - 0.5);
    const double wanted =
        t < 0.0 ? -kBeyond / 2.0 * std::exp(w * t) : -kBeyond * (1.0 - std::exp(-w * t) / 2.0);
    EXPECT_NEAR(shift[i].x(), wanted, 1e-6) << i;
    EXPECT_EQ(shift[i].y(), 0.0);
  }
}

// Between two stances no force accelerates the body, so the shift is a straight line.
TEST(BalancePreview, FlightIsStraight) {
  std::vector<BalanceSample> samples(300);
  for (int i = 0; i < 300; ++i) {
    if (i < 100 || i >= 200) samples[i] = {{1.2, 0.0}, kSquare, 15.0};
  }
  const auto shift = balancing_shift(samples, 0.005, 1.0);
  for (int i = 101; i < 199; ++i) {
    EXPECT_NEAR((shift[i - 1] - 2.0 * shift[i] + shift[i + 1]).norm(), 0.0, 1e-15);
  }
  EXPECT_LT(shift[150].x(), -0.05);
}

TEST(BalancePreview, HandlesShortMotions) {
  EXPECT_TRUE(balancing_shift({}, 0.01, 0.8).empty());
  EXPECT_EQ(balancing_shift(std::vector<BalanceSample>(2), 0.01, 0.8).size(), 2U);
}

}  // namespace
}  // namespace retarget
