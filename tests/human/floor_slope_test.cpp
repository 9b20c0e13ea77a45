#include "human/skeleton/floor_slope.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr int kUp = 1;

// A body that walks along x and z, in legs.
std::vector<Vector3d> walking_places(double length) {
  std::vector<Vector3d> places;
  for (int i = 0; i < 50; ++i) {
    places.emplace_back(length * i / 50.0, 1.0, 0.3 * length * std::sin(0.2 * i));
  }
  return places;
}

std::vector<double> on_slope(const std::vector<Vector3d>& places, double slope) {
  std::vector<double> heights;
  for (const Vector3d& place : places) heights.push_back(2.0 + slope * (place.x() - place.z()));
  return heights;
}

double spread(const std::vector<double>& heights) {
  const auto [low, high] = std::ranges::minmax(heights);
  return high - low;
}

TEST(FloorSlope, IsSubtracted) {
  const std::vector<Vector3d> places = walking_places(8.0);
  for (const double slope : {0.02, -0.1, 0.2}) {
    const std::vector<double> heights = on_slope(places, slope);
    EXPECT_LT(spread(without_slope(heights, places, kUp)), 0.02 * spread(heights)) << slope;
  }
}

TEST(FloorSlope, KeepsTheMeanAndLevelHeights) {
  const std::vector<Vector3d> places = walking_places(8.0);
  const std::vector<double> level(places.size(), 0.7);
  for (const double height : without_slope(level, places, kUp)) EXPECT_NEAR(height, 0.7, 1e-12);
  const auto mean = [](const std::vector<double>& heights) {
    double sum = 0.0;
    for (const double height : heights) sum += height;
    return sum / static_cast<double>(heights.size());
  };
  const std::vector<double> heights = on_slope(places, 0.1);
  EXPECT_NEAR(mean(without_slope(heights, places, kUp)), mean(heights), 1e-9);
}

// A climb, and heights that a body on one spot does not explain.
TEST(FloorSlope, SteepAndUnknownSlopesStay) {
  const std::vector<double> climb = on_slope(walking_places(8.0), 0.5);
  EXPECT_EQ(without_slope(climb, walking_places(8.0), kUp), climb);
  const std::vector<double> standing = on_slope(walking_places(0.02), 0.2);
  EXPECT_GT(spread(without_slope(standing, walking_places(0.02), kUp)), 0.9 * spread(standing));
}

TEST(FloorSlope, NeedsAPlaceForEachHeight) {
  EXPECT_TRUE(without_slope({}, {}, kUp).empty());
  EXPECT_EQ(without_slope({1.0, 2.0}, {Vector3d::Zero()}, kUp), (std::vector{1.0, 2.0}));
}

}  // namespace
}  // namespace retarget
