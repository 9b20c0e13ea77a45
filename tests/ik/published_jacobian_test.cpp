#include "solve/ik/published_jacobian.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "math/lie_series.h"
#include "retarget/so3.h"
#include "support/exp_se3.h"

namespace retarget {
namespace {

// log(exp(d) exp(x)) by central differences in d.
Matrix6d numeric_left_jacobian_inverse(const Vector6d& x) {
  constexpr double kStep = 1e-6;
  Matrix6d jacobian;
  for (int i = 0; i < 6; ++i) {
    const Vector6d d = kStep * Vector6d::Unit(i);
    const Vector6d ahead = log_se3(exp_se3(d) * exp_se3(x));
    const Vector6d behind = log_se3(exp_se3(-d) * exp_se3(x));
    jacobian.col(i) = (ahead - behind) / (2.0 * kStep);
  }
  return jacobian;
}

TEST(PublishedJacobian, MatchesFiniteDifferences) {
  RandomTwists twists;
  for (const double angle : {1e-3, 1e-2, 0.1, 0.7, 1.5, 2.5, 3.0}) {
    const Vector6d x = twists.next(angle);
    EXPECT_LT((published_jacobian_inverse(x) - numeric_left_jacobian_inverse(x)).norm(), 2e-8)
        << angle;
  }
}

TEST(PublishedJacobian, SwitchesToTheIdentityBelowTheSmallAngle) {
  RandomTwists twists;
  EXPECT_EQ(published_jacobian_inverse(twists.next(0.99e-5)), Matrix6d::Identity());
  const Vector6d above = twists.next(1.01e-5);
  EXPECT_NE(published_jacobian_inverse(above), Matrix6d::Identity());
  // Above the switch the position and the rotation are coupled.
  EXPECT_LT((published_jacobian_inverse(above).topRightCorner<3, 3>() + 0.5 * skew(above.head<3>()))
                .norm(),
            1e-5);
}

// The error is at most that stated in the header, and always finite; docs/ik.md explains why the
// forms are kept.
TEST(PublishedJacobian, LosesNoMoreDigitsThanStated) {
  if (std::numeric_limits<series::Real>::digits < 64)
    GTEST_SKIP() << "long double is a double here";
  RandomTwists twists;
  for (double angle = 1.0001e-5; angle < std::numbers::pi; angle *= 1.3) {
    const Vector6d x = twists.next(angle);
    const series::Matrix6 expected = series::left_jacobian(x.cast<series::Real>().eval()).inverse();
    const series::Matrix6 away = published_jacobian_inverse(x).cast<series::Real>() - expected;
    const double bound = 5e-15 + 5e-16 / (angle * angle);
    EXPECT_LE(static_cast<double>(away.norm()), bound) << angle;
  }
}

TEST(PublishedJacobian, IsFiniteAtEveryAngle) {
  RandomTwists twists;
  for (double angle = 1e-16; angle < std::numbers::pi; angle *= 1.07) {
    EXPECT_TRUE(published_jacobian_inverse(twists.next(angle)).allFinite()) << angle;
  }
  for (double away = 1e-16; away < 0.2; away *= 2.0) {
    EXPECT_TRUE(published_jacobian_inverse(twists.next(std::numbers::pi - away)).allFinite())
        << away;
  }
}

}  // namespace
}  // namespace retarget
