// Limits and speed limits hold for every sequence, and sequences within them do not change.

#include "base/math/step_bounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace retarget {
namespace {

TEST(BoundSteps, BoundsHoldForRandomSequences) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(-4.0, 4.0), width(0.01, 1.0);
  for (int round = 0; round < 200; ++round) {
    std::vector<double> values(static_cast<std::size_t>(1 + round % 50));
    for (double& x : values) x = value(random);
    const std::vector<double> given = values;
    const double lower = -value(random) * 0.3 - 1.5, upper = lower + 0.5 + width(random);
    const double step = width(random);
    const double max = bound_steps(values, lower, upper, step);
    for (std::size_t i = 0; i < values.size(); ++i) {
      EXPECT_GE(values[i], lower);
      EXPECT_LE(values[i], upper);
      EXPECT_LE(std::abs(values[i] - given[i]), max + 1e-12);
      if (i == 0) continue;
      EXPECT_LE(std::abs(values[i] - values[i - 1]), step + 1e-12);
    }
  }
}

TEST(BoundSteps, LeavesFeasibleSequencesUnchanged) {
  std::vector<double> values = {0.1, 0.35, 0.3, 0.0, -0.2};
  const std::vector<double> given = values;
  EXPECT_EQ(bound_steps(values, -1.0, 1.0, 0.3), 0.0);
  EXPECT_EQ(values, given);
}

TEST(BoundSteps, SpreadsAJumpOverBothSides) {
  std::vector<double> values = {0, 0, 0, 0, 1, 1, 1, 1};
  bound_steps(values, -5.0, 5.0, 0.2);
  // A frame-by-frame clamp would reach 1 four frames late; this is symmetric about the jump.
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(values[i] + values[values.size() - 1 - i], 1.0, 1e-12);
  }
  EXPECT_NEAR(values[4] - values[3], 0.2, 1e-12);
}

TEST(BoundSteps, BoundsHoldForPrintedNumbers) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(-2.0, 2.0);
  constexpr double kGrid = 1e-6, kStep = 0.1;
  std::vector<double> values(500);
  for (double& x : values) x = value(random);
  bound_steps(values, -1.5, 1.5, kStep - kGrid - 1e-12);
  const auto printed = [](double x) { return std::round(x * 1e6); };
  for (std::size_t i = 1; i < values.size(); ++i) {
    EXPECT_LE(std::abs(printed(values[i]) - printed(values[i - 1])), kStep * 1e6);
  }
}

// Values on a bound and between the bounds, rounded to few digits in degrees.
TEST(BoundSteps, BoundsHoldForNumbersPrintedInDegrees) {
  constexpr double kDegrees = PrintedUnits::kDegrees;
  const StepBounds given{-0.5237, 1.5708, 0.1};
  for (int digits = 1; digits <= 8; ++digits) {
    const PrintedUnits unit{kDegrees, PrintedUnits::kCentimetres};
    const StepBounds bounds = bounds_for_printing(given, digits, false, {&unit, 1});
    EXPECT_GE(bounds.lower, given.lower);
    EXPECT_LT(bounds.lower, given.lower + 0.002);
    const double grid = std::pow(10.0, -digits);
    const auto printed = [&](double x) {
      return std::round(x * kDegrees / grid) * grid / kDegrees;
    };
    for (const double x : {bounds.lower, bounds.lower + 1e-4, bounds.upper - 1e-4, bounds.upper}) {
      EXPECT_GE(printed(x), given.lower - 1e-12) << digits;
      EXPECT_LE(printed(x), given.upper + 1e-12) << digits;
      EXPECT_LE(std::abs(printed(x + bounds.step) - printed(x)), given.step + 1e-12) << digits;
    }
  }
}

// A file without decimals leaves the joints a range.
TEST(BoundSteps, CoarseUnitsGetDecimals) {
  const StepBounds given{-0.5, 1.0, 0.1};
  const PrintedUnits si, others{PrintedUnits::kDegrees, PrintedUnits::kCentimetres};
  const auto lower = [&](int decimals, bool slides, const PrintedUnits& unit) {
    return bounds_for_printing(given, decimals, slides, {&unit, 1}).lower;
  };
  EXPECT_EQ(lower(0, false, si), bounds_for_rounding(given, 3).lower);
  EXPECT_EQ(lower(6, false, si), bounds_for_rounding(given, 6).lower);
  EXPECT_EQ(lower(0, true, others), lower(1, true, others));
  EXPECT_NEAR(lower(0, false, others), -0.5, 0.002);
}

}  // namespace
}  // namespace retarget
