// The square of values below 0 with a gradually starting curvature, against finite differences.

#include "solve/fit/one_sided.h"

#include <gtest/gtest.h>

namespace retarget {
namespace {

constexpr double kBand = 0.003;

TEST(OneSided, IsZeroAboveTheBand) {
  for (const double value : {kBand, 0.01, 1.0}) {
    const OneSidedRow row = one_sided(value, kBand);
    EXPECT_EQ(row.weight, 0.0);
    EXPECT_EQ(row.cost, 0.0);
  }
}

TEST(OneSided, MatchesTheSquareBelowTheBand) {
  const OneSidedRow row = one_sided(-0.02, kBand);
  EXPECT_EQ(row.weight, 1.0);
  EXPECT_EQ(row.residual, -0.02);
}

TEST(OneSided, GradientAndCurvatureMatchTheCost) {
  constexpr double kStep = 1e-7;
  for (double value = -0.0047; value < 0.0045; value += 0.0004) {
    SCOPED_TRACE(value);
    const OneSidedRow row = one_sided(value, kBand);
    const OneSidedRow above = one_sided(value + kStep, kBand);
    const OneSidedRow below = one_sided(value - kStep, kBand);
    const auto half_gradient = [](const OneSidedRow& r) { return r.weight * r.residual; };
    EXPECT_NEAR(0.25 * (above.cost - below.cost) / kStep, half_gradient(row), 1e-8);
    EXPECT_NEAR(0.5 * (half_gradient(above) - half_gradient(below)) / kStep, row.weight, 1e-6);
  }
}

TEST(OneSided, CurvatureIsContinuous) {
  constexpr double kBit = 1e-15;
  for (const double value : {-kBand, 0.0, kBand}) {
    const OneSidedRow above = one_sided(value + kBit, kBand);
    const OneSidedRow below = one_sided(value - kBit, kBand);
    EXPECT_NEAR(above.weight, below.weight, 1e-12);
    EXPECT_NEAR(above.cost, below.cost, 1e-16);
  }
}

}  // namespace
}  // namespace retarget
