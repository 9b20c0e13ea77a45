#include "robot/model/sole_ends.h"

#include <gtest/gtest.h>

namespace retarget {
namespace {

using Eigen::Vector3d;

// A sole of 20 x 6 cm, 5 cm below the origin, with its centre line offset by `aside` metres.
Sole sole_beside(double aside) {
  Sole sole;
  sole.side = "left";
  for (const double x : {-0.05, 0.15}) {
    for (const double y : {0.03, -0.03}) sole.points.emplace_back(x, aside + y, -0.05);
  }
  sole.labels = {"heel_left", "heel_right", "toe_left", "toe_right"};
  return sole;
}

TEST(SoleEndsTest, SidewaysAxisLiesInTheSoleForAnyOrigin) {
  for (const double aside : {0.0, 0.037, -0.037, 0.2}) {
    const auto shape = sole_shape(sole_beside(aside)).value();
    EXPECT_LT((shape.sideways - Vector3d(0, 1, 0)).norm(), 1e-12) << aside;
    EXPECT_NEAR(shape.body_height, 0.05, 1e-12) << aside;
    EXPECT_NEAR(shape.ends[kSoleHeel].half_width, 0.03, 1e-12) << aside;
  }
}

TEST(SoleEndsTest, OriginDeterminesTheUpAxisOfALine) {
  Sole sole;
  sole.points = {Vector3d(-0.05, 0, -0.04), Vector3d(0.15, 0, -0.04)};
  sole.labels = {"heel", "toe"};
  const auto shape = sole_shape(sole).value();
  EXPECT_LT((shape.sideways - Vector3d(0, 1, 0)).norm(), 1e-12);
  EXPECT_NEAR(shape.body_height, 0.04, 1e-12);
}

}  // namespace
}  // namespace retarget
