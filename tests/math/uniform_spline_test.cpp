#include "base/math/uniform_spline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "retarget/spline.h"

namespace retarget {
namespace {

constexpr double kNoBound = std::numeric_limits<double>::infinity();

std::vector<double> random_samples(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> samples;
  for (int i = 0; i < count; ++i) samples.push_back(normal(random));
  return samples;
}

TEST(UniformSpline, IsTheNotAKnotSpline) {
  for (const int count : {1, 2, 3, 4, 5, 40}) {
    const std::vector<double> samples = random_samples(count, 3);
    const UniformSpline spline(samples);
    ASSERT_EQ(spline.piece_count(), std::max(1, count - 1));
    std::vector<Eigen::Vector3d> points;
    for (const double sample : samples) points.emplace_back(sample, 0.0, 0.0);
    const auto velocities = spline_velocities(steps_between(points));
    for (int i = 0; i + 1 < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      for (const double s : {0.0, 0.3, 1.0}) {
        const double expected =
            interpolate_cubic(points[at], velocities[at], points[at + 1], velocities[at + 1], s)
                .x();
        EXPECT_NEAR(spline.at(i, s).value, expected, 1e-12);
      }
    }
    EXPECT_NEAR(spline.at(0, 0.0).value, samples[0], 1e-12);
  }
}

TEST(UniformSpline, HasContinuousSecondDerivativesAlsoWhenCorrected) {
  UniformSpline spline(random_samples(30, 4));
  for (const bool corrected : {false, true}) {
    if (corrected) spline.keep_inside({-1.0, 1.0, kNoBound});
    for (int i = 0; i + 1 < spline.piece_count(); ++i) {
      const SplineState end = spline.at(i, 1.0), begin = spline.at(i + 1, 0.0);
      EXPECT_NEAR(end.value, begin.value, 1e-12);
      EXPECT_NEAR(end.velocity, begin.velocity, 1e-12);
      EXPECT_NEAR(end.acceleration, begin.acceleration, 1e-11);
    }
  }
}

TEST(UniformSpline, ExtremesAreThoseOfManySamples) {
  const UniformSpline spline(random_samples(50, 5));
  for (int i = 0; i < spline.piece_count(); ++i) {
    const UniformSpline::Range values = spline.values(i), rates = spline.velocities(i);
    double least = kNoBound, greatest = -kNoBound, slowest = kNoBound, fastest = -kNoBound;
    for (int k = 0; k <= 2000; ++k) {
      const SplineState state = spline.at(i, k / 2000.0);
      least = std::min(least, state.value);
      greatest = std::max(greatest, state.value);
      slowest = std::min(slowest, state.velocity);
      fastest = std::max(fastest, state.velocity);
    }
    EXPECT_NEAR(values.least.value, least, 1e-6);
    EXPECT_NEAR(values.greatest.value, greatest, 1e-6);
    EXPECT_NEAR(rates.least.value, slowest, 1e-6);
    EXPECT_NEAR(rates.greatest.value, fastest, 1e-6);
    EXPECT_LE(values.least.value, least + 1e-12);
    EXPECT_GE(values.greatest.value, greatest - 1e-12);
    EXPECT_NEAR(spline.at(i, values.greatest.at - i).value, values.greatest.value, 1e-12);
    EXPECT_NEAR(spline.at(i, rates.greatest.at - i).velocity, rates.greatest.value, 1e-12);
  }
}

// A joint that rests at its limit, leaves it and returns overshoots between samples.
TEST(UniformSpline, KeepsPositionsBetweenSamples) {
  std::vector<double> samples(40, 1.0);
  for (int i = 15; i < 22; ++i) samples[static_cast<std::size_t>(i)] = 0.2 * (i % 3);
  UniformSpline spline(samples);
  double before = 0.0;
  for (int i = 0; i < spline.piece_count(); ++i) {
    before = std::max(before, spline.values(i).greatest.value);
  }
  EXPECT_GT(before, 1.02);
  const SplineCorrection correction = spline.keep_inside({-2.0, 1.0, kNoBound});
  EXPECT_GT(correction.largest, 0.01);
  EXPECT_LT(correction.largest, 0.25);
  EXPECT_NEAR(correction.at, 18.0, 6.0);
  for (int i = 0; i < spline.piece_count(); ++i) {
    EXPECT_LE(spline.values(i).greatest.value, 1.0);
  }
  EXPECT_NEAR(spline.at(3, 0.0).value, 1.0, 1e-3);
}

TEST(UniformSpline, KeepsSpeedsBetweenSamples) {
  // Steps of at most 0.5, with kinks.
  std::vector<double> samples;
  for (int i = 0; i < 60; ++i) samples.push_back(0.5 * std::abs((i + 4) % 12 - 6));
  UniformSpline spline(samples);
  double before = 0.0;
  for (int i = 0; i < spline.piece_count(); ++i) {
    before = std::max(before, spline.velocities(i).greatest.value);
  }
  EXPECT_GT(before, 0.55);
  spline.keep_inside({-kNoBound, kNoBound, 0.5});
  for (int i = 0; i < spline.piece_count(); ++i) {
    EXPECT_LE(spline.velocities(i).greatest.value, 0.5);
    EXPECT_GE(spline.velocities(i).least.value, -0.5);
  }
}

TEST(UniformSpline, DoesNotChangeValuesInsideTheBounds) {
  const std::vector<double> samples = random_samples(30, 6);
  UniformSpline spline(samples);
  const UniformSpline unchanged = spline;
  const SplineCorrection correction = spline.keep_inside({-50.0, 50.0, 50.0});
  EXPECT_EQ(correction.largest, 0.0);
  EXPECT_EQ(correction.excess, 0.0);
  for (int i = 0; i < spline.piece_count(); ++i) {
    EXPECT_EQ(spline.at(i, 0.4).value, unchanged.at(i, 0.4).value);
  }
}

// Samples beyond a bound stay there, and pieces farther away keep it.
TEST(UniformSpline, SamplesBeyondABoundDoNotChange) {
  std::vector<double> samples(20, 0.0);
  samples[10] = 3.0;
  UniformSpline spline(samples);
  samples[3] = samples[16] = 1.0;
  spline = UniformSpline(samples);
  const SplineCorrection correction = spline.keep_inside({-1.0, 1.0, 2.0});
  EXPECT_LT(correction.excess, 1e-12);
  EXPECT_NEAR(spline.at(10, 0.0).value, 3.0, 1e-2);
  for (int i = 0; i < spline.piece_count(); ++i) {
    if (i >= 7 && i <= 12) continue;
    EXPECT_LE(spline.values(i).greatest.value, 1.0);
    EXPECT_LE(spline.velocities(i).greatest.value, 2.0);
  }
}

}  // namespace
}  // namespace retarget
