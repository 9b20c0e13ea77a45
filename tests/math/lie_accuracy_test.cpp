#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/math/se3.h"
#include "math/lie_series.h"
#include "retarget/so3.h"
#include "support/angles.h"

namespace retarget {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using series::Real;

// Relative to the norm of the whole result. A map is a sum of at most six products, each with at
// most three rounding errors of 1.1e-16; the rest is margin for the norm of the terms relative to
// that of their sum, at most pi / 2 up to half a turn.
constexpr double kBound = 5e-15;

const std::array<Vector3d, 3> kAxes = {Vector3d(1.0, -2.0, 0.5).normalized(), Vector3d::UnitY(),
                                       Vector3d(1e-9, 0.3, -1.0).normalized()};
const Vector3d kVector(0.3, 0.9, -0.7);

// From 1e-300 to half a turn, closely around thresholds, and towards half a turn.
std::vector<double> angles() {
  std::vector<double> all = {0.0, 1e-300, 1e-160, 1e-20};
  for (int decade = -16; decade <= 0; ++decade) {
    for (const double digit : {1.0, 1.5, 2.2, 3.1, 5.0, 7.0}) {
      const double angle = digit * std::pow(10.0, decade);
      if (angle < kPi) all.push_back(angle);
    }
  }
  for (const double threshold : {1e-10, 1e-5, 1e-4, 0.03, 0.2, 0.5, 1.0}) {
    for (const double away : {-1e-3, -1e-15, 1e-15, 1e-3}) all.push_back(threshold * (1.0 + away));
  }
  for (int decade = -16; decade < 0; ++decade) all.push_back(kPi - std::pow(10.0, decade));
  all.push_back(kPi);
  return all;
}

template <typename Value>
auto exact(const Value& value) {
  return value.template cast<Real>().eval();
}

template <typename Found, typename Expected>
double relative_error(const Found& found, const Expected& expected) {
  const Real size = expected.stableNorm();
  const Real away = (exact(found) - expected).stableNorm();
  return static_cast<double>(size > 0 ? away / size : away);
}

class LieAccuracy : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::numeric_limits<Real>::digits < 64) {
      GTEST_SKIP() << "long double is no more exact than double here";
    }
  }

  // Over all angles and axes.
  template <typename Check>
  static void for_all(const Check& check) {
    for (const double angle : angles()) {
      for (const Vector3d& axis : kAxes) {
        SCOPED_TRACE(::testing::Message() << "angle " << angle << " about " << axis.transpose());
        check(Vector3d(angle * axis));
      }
    }
  }
};

TEST_F(LieAccuracy, ExpSo3) {
  for_all([](const Vector3d& w) {
    const Quaterniond q = exp_so3(w);
    const series::Vector4 expected = series::quaternion(exact(w));
    EXPECT_LE(relative_error(Vector3d(q.vec()), expected.tail<3>().eval()), kBound);
    EXPECT_LE(std::abs(static_cast<double>(q.w() - expected[0])), kBound);
  });
}

// The exponential of the result must be the quaternion. An error of the vector is half as large
// there: in the vector part for small angles, where the scalar part holds too few digits to tell,
// and in both for large ones.
TEST_F(LieAccuracy, LogSo3) {
  for_all([](const Vector3d& w) {
    const Quaterniond q = exp_so3(w);
    if (q.vec().isZero(0.0)) return;  // the angle is beyond what a quaternion stores
    const Vector3d found = log_so3(q);
    series::Vector4 given;
    given << q.w(), q.x(), q.y(), q.z();
    given /= given.stableNorm();
    series::Vector4 reached = series::quaternion(exact(found));
    if (reached.dot(given) < 0) reached = -reached;
    const Real size = exact(found).stableNorm();
    series::Vector4 away = reached - given;
    if (size < 1) away[0] = 0;
    EXPECT_LE(static_cast<double>(2 * away.stableNorm() / size), kBound);
  });
}

TEST_F(LieAccuracy, LeftJacobianInverseSo3) {
  for_all([](const Vector3d& w) {
    const series::Matrix3 expected = series::left_jacobian(exact(w)).inverse();
    EXPECT_LE(relative_error(left_jacobian_inverse_so3(w), expected), kBound);
    EXPECT_LE(relative_error(apply_left_jacobian_inverse_so3(w, kVector),
                             (expected * exact(kVector)).eval()),
              kBound);
  });
}

TEST_F(LieAccuracy, RightJacobianSo3) {
  for_all([](const Vector3d& w) {
    const series::Matrix3 expected = series::left_jacobian((-exact(w)).eval());
    EXPECT_LE(relative_error(right_jacobian_so3(w), expected), kBound);
  });
}

TEST_F(LieAccuracy, RightJacobianRateSo3) {
  for_all([](const Vector3d& w) {
    const Vector3d across = w.norm() > 0.0 ? w.normalized().unitOrthogonal() : Vector3d::UnitX();
    // Along w the Jacobian does not change in a way that affects the rate.
    for (const Vector3d& rate : {kVector, across}) {
      const series::Vector3 expected = series::right_jacobian_rate(exact(w), exact(rate));
      EXPECT_LE(relative_error(right_jacobian_rate_so3(w, rate), expected), kBound);
    }
  });
}

// V v is the translation; V^-1 is at most pi / 2 times as large as V is small.
TEST_F(LieAccuracy, LogSe3) {
  for_all([](const Vector3d& w) {
    const Pose pose{exp_so3(w), kVector};
    const Vector6d found = log_se3(pose);
    EXPECT_EQ(found.tail<3>(), log_so3(pose.rotation));
    const series::Vector3 reached =
        series::left_jacobian(exact(Vector3d(found.tail<3>()))) * exact(Vector3d(found.head<3>()));
    EXPECT_LE(relative_error(kVector, reached), kBound);
  });
}

// The rotation about an axis orthogonal to both directions maps one to the other, even if they are
// nearly opposite and the axis is arbitrary. Eigen's closed form, used except within 2.6 degrees of
// opposite, loses 2e-16 / (1 + cosine).
TEST(RotationBetween, IsExactUpToOppositeDirections) {
  for (const double angle : angles()) {
    for (const Vector3d& axis : kAxes) {
      const Vector3d a = axis.unitOrthogonal(), b = exp_so3(angle * axis) * (2.0 * a);
      const Quaterniond turn = rotation_between(3.0 * a, b);
      EXPECT_NEAR(turn.norm(), 1.0, 1e-13) << angle;
      EXPECT_LE((turn * a - 0.5 * b).norm(), 1e-13) << angle;
      EXPECT_LE(std::abs(turn.vec().dot(a)), 1e-15) << angle;
    }
  }
  EXPECT_LE((rotation_between(kVector, -kVector) * kVector + kVector).norm(), 2e-15);
}

}  // namespace
}  // namespace retarget
