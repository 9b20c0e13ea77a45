#include "retarget/trigonometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace retarget::portable {
namespace {

// Distance in units in the last place from the exact value, which a 64-bit long double represents.
double ulps(double found, long double exact) {
  const double nearest = static_cast<double>(exact);
  const double unit = std::nextafter(std::abs(nearest), std::numeric_limits<double>::infinity()) -
                      std::abs(nearest);
  return static_cast<double>(std::abs(static_cast<long double>(found) - exact)) / unit;
}

#ifndef _WIN32  // MinGW's long double sine is that of x87, less accurate than ours.
TEST(SinCos, IsWithinAFewUlps) {
  std::mt19937_64 random(1);
  for (const double range : {1e-8, 0.1, 1.0, 4.0, 100.0, 9e5}) {
    const double max = range > 100.0 ? 3.0 : 2.0;
    std::uniform_real_distribution<double> angles(-range, range);
    for (int i = 0; i < 100'000; ++i) {
      const double angle = angles(random);
      const auto [sine, cosine] = sin_cos(angle);
      ASSERT_LT(ulps(sine, std::sin(static_cast<long double>(angle))), max) << angle;
      ASSERT_LT(ulps(cosine, std::cos(static_cast<long double>(angle))), max) << angle;
    }
  }
}
#endif

#ifndef _WIN32  // MinGW's long double sine is that of x87, less accurate than ours.
TEST(SinCos, IsExactAtSpecialAngles) {
  EXPECT_EQ(sin_cos(0.0).sine, 0.0);
  EXPECT_EQ(sin_cos(0.0).cosine, 1.0);
  EXPECT_EQ(sin_cos(std::numbers::pi / 2.0).sine, 1.0);
  EXPECT_EQ(sin_cos(std::numbers::pi).cosine, -1.0);
  // The tiny remainders of pi as a double.
  for (int k = 1; k <= 1000; ++k) {
    const double angle = k * std::numbers::pi / 2.0;
    const auto [sine, cosine] = sin_cos(angle);
    EXPECT_LT(
        ulps(k % 2 == 0 ? sine : cosine, k % 2 == 0 ? std::sin(static_cast<long double>(angle))
                                                    : std::cos(static_cast<long double>(angle))),
        1e3)
        << k;
    EXPECT_NEAR(sine, std::sin(angle), 1e-16) << k;
    EXPECT_NEAR(cosine, std::cos(angle), 1e-16) << k;
  }
}
#endif

TEST(SinCos, HandlesAnyAngle) {
  for (const double angle : {1.0000001e6, -3e7, 1e15, 1e300}) {
    const auto [sine, cosine] = sin_cos(angle);
    EXPECT_NEAR(sine * sine + cosine * cosine, 1.0, 1e-15);
  }
  EXPECT_NEAR(sin_cos(1.5e6).sine, std::sin(1.5e6), 1e-9);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(sin_cos(infinity).sine));
  EXPECT_TRUE(std::isnan(sin_cos(std::nan("")).cosine));
}

TEST(SinCosOfHalfDegrees, IsWithinTwoUlps) {
  std::mt19937_64 random(2);
  for (const double range : {1e-6, 1.0, 90.0, 180.0, 720.0, 1e6}) {
    std::uniform_real_distribution<double> angles(-range, range);
    for (int i = 0; i < 100'000; ++i) {
      const double degrees = angles(random);
      const auto [sine, cosine] = sin_cos_of_half_degrees(degrees);
      // The argument is reduced exactly to a quarter turn; near it, not even pi as a long double
      // would suffice.
      const long double quadrant = std::nearbyint(static_cast<long double>(degrees) / 180.0L);
      const long double rest =
          (degrees - 180.0L * quadrant) * std::numbers::pi_v<long double> / 360.0L;
      const long double sines[] = {std::sin(rest), std::cos(rest), -std::sin(rest),
                                   -std::cos(rest)};
      const auto index = static_cast<std::size_t>(static_cast<long>(quadrant)) % 4;
      ASSERT_LT(ulps(sine, sines[index]), 2.0) << degrees;
      ASSERT_LT(ulps(cosine, sines[(index + 1) % 4]), 2.0) << degrees;
    }
  }
}

TEST(SinCosOfHalfDegrees, WholeTurnsAreExact) {
  for (int turns = -5; turns <= 5; ++turns) {
    const auto [sine, cosine] = sin_cos_of_half_degrees(360.0 * turns);
    EXPECT_EQ(sine, 0.0) << turns;
    EXPECT_EQ(cosine, turns % 2 == 0 ? 1.0 : -1.0) << turns;
    const auto half = sin_cos_of_half_degrees(360.0 * turns + 180.0);
    EXPECT_EQ(half.cosine, 0.0) << turns;
    EXPECT_EQ(std::abs(half.sine), 1.0) << turns;
  }
}

TEST(Atan2, IsWithinTwoUlps) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponents(-30.0, 30.0);
  for (int i = 0; i < 300'000; ++i) {
    const double y = normal(random);
    const double x = normal(random) * (i % 2 == 0 ? 1.0 : std::pow(10.0, exponents(random)));
    ASSERT_LT(
        ulps(atan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x))),
        2.0)
        << y << " " << x;
  }
}

TEST(Atan2, MatchesStdAtan2AtSpecialValues) {
  const double min = std::numeric_limits<double>::denorm_min();
  const double small = std::numeric_limits<double>::min();
  const double max = std::numeric_limits<double>::max();
  for (const double y : {0.0, -0.0, 1.0, -1.0, min, -small, max, -max, 0.4375, 0.6875}) {
    for (const double x : {0.0, -0.0, 1.0, -1.0, min, -small, max, -max}) {
      const double found = atan2(y, x);
      EXPECT_EQ(std::signbit(found), std::signbit(y)) << y << " " << x;
      EXPECT_NEAR(found, std::atan2(y, x), 5e-16) << y << " " << x;
    }
  }
  EXPECT_TRUE(std::isnan(atan2(std::nan(""), 1.0)));
  EXPECT_TRUE(std::isnan(atan2(1.0, std::numeric_limits<double>::infinity())));
}

}  // namespace
}  // namespace retarget::portable
