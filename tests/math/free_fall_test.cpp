#include "base/math/free_fall.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace retarget {
namespace {

using Eigen::Vector3d;

TEST(FreeFallParabola, IsRecovered) {
  constexpr double kStep = 1.0 / 30.0;
  const Vector3d speed(1.0, -2.0, 3.0), acceleration(0.5, 0.0, -9.81);
  std::vector<Vector3d> places;
  for (int i = 0; i < 7; ++i) {
    const double time = i * kStep;
    places.emplace_back(Vector3d(4.0, 5.0, 6.0) + time * speed + 0.5 * time * time * acceleration);
  }
  const Parabola exact = fit_parabola(places, kStep);
  EXPECT_NEAR((exact.acceleration - acceleration).norm(), 0.0, 1e-9);
  EXPECT_NEAR(exact.residual, 0.0, 1e-9);
  places[3].z() += 0.01;
  EXPECT_GT(fit_parabola(places, kStep).residual, 0.002);
}

TEST(FreeFallParabola, ReachesATenthOfASecond) {
  for (const auto& [rate, reach] : {std::pair{10.0, 0},
                                    {15.0, 2},
                                    {20.0, 2},
                                    {23.976, 3},
                                    {24.0, 3},
                                    {25.0, 3},
                                    {29.97, 3},
                                    {30.0, 3},
                                    {60.0, 6}}) {
    EXPECT_EQ(free_fall_reach(1.0 / rate), reach) << rate;
  }
}

}  // namespace
}  // namespace retarget
