#include "retarget/filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "retarget/so3.h"
#include "support/angles.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

const Vector3d kFilterAxis = Vector3d(1.0, -2.0, 0.5).normalized();

// Response of symmetric taps to a tone of `frequency` cycles per sample: the factor on its
// amplitude (the phase does not change).
double gain(std::span<const double> taps, double frequency) {
  const std::size_t half = taps.size() / 2;
  double sum = taps[half];
  for (std::size_t k = 1; k <= half; ++k) {
    sum += 2.0 * taps[half + k] * std::cos(2.0 * kPi * frequency * static_cast<double>(k));
  }
  return sum;
}

TEST(DesignLowPass, IsSymmetricWithSumOne) {
  for (const int half_width : {0, 1, 24, 300}) {
    const auto taps = design_low_pass(0.1, half_width);
    ASSERT_EQ(taps.size(), 2U * half_width + 1);
    EXPECT_NEAR(std::accumulate(taps.begin(), taps.end(), 0.0), 1.0, 1e-15);
    for (int k = 0; k <= half_width; ++k) {
      EXPECT_EQ(taps[half_width - k], taps[half_width + k]);
    }
  }
}

TEST(AntiAliasTaps, ResponseFrom120To30) {
  const auto taps = anti_alias_taps(4.0);
  EXPECT_EQ(taps.size(), 49U);
  EXPECT_NEAR(gain(taps, 0.0), 1.0, 1e-15);
  EXPECT_NEAR(gain(taps, 8.0 / 120.0), 0.988, 0.002);
  EXPECT_NEAR(gain(taps, 12.0 / 120.0), 0.5, 0.005);
  EXPECT_NEAR(gain(taps, 15.0 / 120.0), 0.055, 0.005);
  for (double frequency = 20.0; frequency <= 60.0; frequency += 0.25) {
    EXPECT_LT(std::abs(gain(taps, frequency / 120.0)), 1e-3) << frequency;
  }
}

TEST(AntiAliasTaps, ResponseScalesWithTheOutputRate) {
  for (const double ratio : {1.25, 1.998, 2.0, 3.996, 250.0 / 30.0, 100.0}) {
    const auto taps = anti_alias_taps(ratio);
    const auto at = [&](double of_output_rate) { return gain(taps, of_output_rate / ratio); };
    EXPECT_NEAR(at(8.0 / 30.0), 0.988, 0.01) << ratio;
    EXPECT_NEAR(at(0.4), 0.5, 0.01) << ratio;
    EXPECT_NEAR(at(0.5), 0.055, 0.02) << ratio;
    // The band that aliases into the visible band, up to half the input rate.
    for (double f = 2.0 / 3.0; f <= 0.5 * ratio; f += 0.01) EXPECT_LT(std::abs(at(f)), 1.5e-3);
  }
}

TEST(AntiAliasTaps, TapCountIsBoundedForExtremeRates) {
  EXPECT_LE(anti_alias_taps(1e9).size(), 2049U);
}

std::vector<Vector3d> ramp(int count) {
  std::vector<Vector3d> points;
  for (int i = 0; i < count; ++i) points.emplace_back(3.0 + 0.5 * i, -2.0 * i, 7.0);
  return points;
}

TEST(LowPass, PreservesConstantsAndRamps) {
  const auto taps = anti_alias_taps(4.0);
  for (const int count : {1, 2, 3, 10, 24, 25, 49, 200}) {
    const auto points = ramp(count);
    const auto filtered = low_pass(points, taps);
    ASSERT_EQ(filtered.size(), points.size());
    for (int i = 0; i < count; ++i) {
      EXPECT_LE((filtered[i] - points[i]).norm(), 1e-13 * (1.0 + points[i].norm())) << count;
    }
  }
  EXPECT_TRUE(low_pass(std::span<const Vector3d>(), taps).empty());
  EXPECT_TRUE(low_pass(std::span<const Quaterniond>(), taps).empty());
}

TEST(LowPass, AttenuatesASineAsDesigned) {
  const auto taps = anti_alias_taps(4.0);
  for (const double frequency : {3.0, 8.0, 12.0, 20.0, 25.0}) {
    std::vector<Vector3d> points;
    for (int i = 0; i < 240; ++i) {
      points.emplace_back(Vector3d::Constant(std::sin(2.0 * kPi * frequency * i / 120.0 + 0.3)));
    }
    const auto filtered = low_pass(points, taps);
    const double expected = gain(taps, frequency / 120.0);
    for (int i = 24; i < 216; ++i) {
      EXPECT_NEAR(filtered[i].x(), expected * points[i].x(), 1e-12) << frequency;
    }
  }
}

TEST(LowPass, PreservesFirstAndLastSample) {
  std::vector<Vector3d> points;
  for (int i = 0; i < 100; ++i) points.emplace_back(std::cos(0.3 * i), i * i, std::sin(2.0 * i));
  const auto filtered = low_pass(points, anti_alias_taps(4.0));
  EXPECT_LE((filtered.front() - points.front()).norm(), 1e-10);
  EXPECT_LE((filtered.back() - points.back()).norm(), 1e-10);
}

TEST(LowPassRotations, PreservesConstantVelocity) {
  const auto taps = anti_alias_taps(4.0);
  for (const double rate : {0.0, 0.01, 0.3, 0.9}) {  // up to 17 turns a second at 120 Hz
    for (const int count : {1, 2, 5, 30, 120}) {
      std::vector<Quaterniond> rotations;
      for (int i = 0; i < count; ++i) rotations.push_back(exp_so3((0.2 + rate * i) * kFilterAxis));
      const auto filtered = low_pass(rotations, taps);
      for (int i = 0; i < count; ++i) {
        EXPECT_LE((filtered[i].coeffs() - rotations[i].coeffs()).norm(), 1e-13) << rate << " " << i;
      }
    }
  }
}

TEST(LowPassRotations, AttenuatesASmallSineLikeItsAngle) {
  const auto taps = anti_alias_taps(4.0);
  for (const double frequency : {3.0, 8.0, 12.0, 20.0}) {
    std::vector<Quaterniond> rotations;
    const auto angle = [&](int i) { return 0.02 * std::sin(2.0 * kPi * frequency * i / 120.0); };
    for (int i = 0; i < 240; ++i) rotations.push_back(exp_so3(angle(i) * kFilterAxis));
    const auto filtered = low_pass(rotations, taps);
    for (int i = 24; i < 216; ++i) {
      const Vector3d expected = gain(taps, frequency / 120.0) * angle(i) * kFilterAxis;
      EXPECT_LE((log_so3(filtered[i]) - expected).norm(), 2e-6) << frequency;
    }
  }
}

// The accuracy stated in the header: components against a filter of the angle itself.
TEST(LowPassRotations, IsAccurateForLargeSwings) {
  const auto taps = anti_alias_taps(4.0);
  std::vector<Vector3d> angles;
  std::vector<Quaterniond> rotations;
  for (int i = 0; i < 240; ++i) {
    angles.emplace_back(0.5 * std::sin(2.0 * kPi * 3.0 * i / 120.0) * kFilterAxis);
    rotations.push_back(exp_so3(angles.back()));
  }
  const auto by_angle = low_pass(angles, taps);
  const auto by_components = low_pass(rotations, taps);
  for (int i = 0; i < 240; ++i) {
    EXPECT_LE((log_so3(by_components[i]) - by_angle[i]).norm(), 1e-3) << i;
  }
}

// Only sign flips, which violate the precondition, make the sum vanish this easily.
TEST(LowPassRotations, KeepsSampleIfTheSumVanishes) {
  std::vector<Quaterniond> rotations(9, Quaterniond(1, 0, 0, 0));
  for (std::size_t i = 1; i < rotations.size(); i += 2) rotations[i] = Quaterniond(-1, 0, 0, 0);
  const auto filtered = low_pass(rotations, std::vector<double>{0.25, 0.5, 0.25});
  for (std::size_t i = 1; i + 1 < rotations.size(); ++i) {
    EXPECT_EQ(filtered[i].coeffs(), rotations[i].coeffs());
  }
}

}  // namespace
}  // namespace retarget
