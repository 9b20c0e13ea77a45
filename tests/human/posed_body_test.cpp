#include "human/skeleton/posed_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "retarget/so3.h"

namespace retarget {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(MinimalRotation, IsExactUpToOppositeDirections) {
  const Vector3d axis = Vector3d(1.0, -2.0, 0.5).normalized(), from = axis.unitOrthogonal();
  for (int decade = -16; decade <= 0; ++decade) {
    for (const double digit : {1.0, 2.2, 3.1}) {
      const double small = digit * std::pow(10.0, decade);
      for (const double angle : {small, std::numbers::pi - small}) {
        const Vector3d to = (exp_so3(angle * axis) * from).normalized();
        const Matrix3d turn = minimal_rotation(from, to, axis);
        // Up to 2.6 degrees from opposite directions, Rodrigues' formula divides rounding errors by
        // 1 + cosine.
        const double cosine = from.dot(to);
        const double rounding = cosine < -0.999 ? 0.0 : 4e-16 / (1.0 + cosine);
        EXPECT_LE((turn * from - to).norm(), 2e-15 + rounding) << angle;
        EXPECT_LE((turn * turn.transpose() - Matrix3d::Identity()).norm(), 4e-15 + rounding)
            << angle;
      }
    }
  }
  const Matrix3d half_turn = minimal_rotation(from, -from, axis);
  EXPECT_LE((half_turn * from + from).norm(), 1e-15);
  EXPECT_LE((half_turn * axis - axis).norm(), 1e-15);
}

}  // namespace
}  // namespace retarget
