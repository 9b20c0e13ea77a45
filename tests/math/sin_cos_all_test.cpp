#include "base/math/simd.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "retarget/trigonometry.h"

namespace retarget {
namespace {

void expect_same_bits(const std::vector<double>& angles) {
  std::vector<double> sines(angles.size()), cosines(angles.size());
  sin_cos_all(angles, sines, cosines);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const auto [sine, cosine] = portable::sin_cos(angles[i]);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(sines[i]), std::bit_cast<std::uint64_t>(sine)) << i;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(cosines[i]), std::bit_cast<std::uint64_t>(cosine)) << i;
  }
}

TEST(SinCosAll, GivesTheBitsOfSingleAngles) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const double size : {1e-9, 0.3, 5.0, 1e4}) {
    for (std::size_t count = 0; count < 40; ++count) {
      std::vector<double> angles(count);
      for (double& angle : angles) angle = size * normal(random);
      expect_same_bits(angles);
    }
  }
}

TEST(SinCosAll, HandlesLargeAndNonFiniteAngles) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  expect_same_bits({0.0, -0.0, 1e6, -1e6, 1.0, 2e6, -1e300, 3.0, kInfinity, -kInfinity,
                    std::numeric_limits<double>::quiet_NaN(), 0.5});
}

}  // namespace
}  // namespace retarget
