#include "retarget/so3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/angles.h"

namespace retarget {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

const Vector3d kAxis = Vector3d(1.0, -2.0, 0.5).normalized();

// Compares scaled values, so that tiny ones matter too.
void expect_near(const Vector3d& actual, const Vector3d& expected, double relative) {
  EXPECT_LE((actual - expected).norm(), relative * expected.norm())
      << actual.transpose() << " in place of " << expected.transpose();
}

TEST(ExpSo3, MatchesAxisAngleRotation) {
  for (const double angle : {0.3, 1.0, 2.0, 3.0, kPi, 5.0}) {
    const Quaterniond expected(AngleAxisd(angle, kAxis));
    EXPECT_LE((exp_so3(angle * kAxis).coeffs() - expected.coeffs()).norm(), 1e-15) << angle;
  }
  EXPECT_EQ(exp_so3(Vector3d::Zero()).coeffs(), Quaterniond::Identity().coeffs());
}

TEST(ExpSo3, IsAccurateForSmallAngles) {
  // On both sides of the switch to the series, against the first terms in higher precision.
  for (const double angle : {1e-300, 1e-20, 1e-8, 1e-5, 9.999e-5, 1.0001e-4, 1e-3}) {
    const long double half = 0.5L * angle;
    const auto sine = static_cast<double>(half - half * half * half / 6.0L +
                                          half * half * half * half * half / 120.0L);
    expect_near(exp_so3(angle * kAxis).vec(), sine * kAxis, 4e-16);
    EXPECT_NEAR(exp_so3(angle * kAxis).norm(), 1.0, 3e-16);
  }
}

TEST(LogSo3, InvertsExp) {
  for (const double angle : {1e-300, 1e-20, 1e-8, 9.999e-5, 1.0001e-4, 0.1, 1.0, 3.0, 3.14159}) {
    expect_near(log_so3(exp_so3(angle * kAxis)), angle * kAxis, 1e-15);
  }
  EXPECT_EQ(log_so3(Quaterniond::Identity()), Vector3d::Zero());
}

TEST(LogSo3, UsesTheShorterRotationForBothSigns) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1000; ++i) {
    const Quaterniond q =
        Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
    const Vector3d w = log_so3(q);
    EXPECT_EQ(w, log_so3(Quaterniond(-q.coeffs())));
    EXPECT_LE(w.norm(), kPi * (1.0 + 1e-15));
    EXPECT_NEAR(std::abs(exp_so3(w).dot(q)), 1.0, 1e-15);
  }
  expect_near(log_so3(exp_so3(4.0 * kAxis)), (4.0 - 2.0 * kPi) * kAxis, 1e-15);
}

TEST(LogSo3, IsDefinedAtHalfATurn) {
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1), kAxis}) {
    for (const double sign : {1.0, -1.0}) {
      const Vector3d half_axis = sign * axis;
      const Quaterniond q(0.0, half_axis.x(), half_axis.y(), half_axis.z());
      expect_near(log_so3(q), kPi * axis, 1e-15);
      EXPECT_EQ(log_so3(q), log_so3(Quaterniond(-q.coeffs())));
    }
  }
  // Just before half a turn, the axis is that of the rotation.
  expect_near(log_so3(exp_so3(-(kPi - 1e-9) * kAxis)), -(kPi - 1e-9) * kAxis, 1e-15);
}

TEST(LogSo3, DoesNotNeedUnitLength) {
  for (const double angle : {1e-9, 0.5, 3.0}) {
    Quaterniond q = exp_so3(angle * kAxis);
    q.coeffs() *= 3.0;
    expect_near(log_so3(q), angle * kAxis, 1e-15);
  }
}

TEST(LeftJacobianInverse, IsTheDerivativeOfTheLog) {
  const Vector3d v(0.3, 0.9, -0.7);
  constexpr double kStep = 1e-5;
  for (const double angle : {0.0, 1e-4, 0.0299, 0.0301, 1.0, 3.0}) {
    const Vector3d w = angle * kAxis;
    const Vector3d slope =
        (log_so3(exp_so3(kStep * v) * exp_so3(w)) - log_so3(exp_so3(-kStep * v) * exp_so3(w))) /
        (2.0 * kStep);
    EXPECT_LE((apply_left_jacobian_inverse_so3(w, v) - slope).norm(), 1e-9) << angle;
  }
}

TEST(AngleBetween, IsAccurateForAllLengthsAndNear0AndPi) {
  const Vector3d side = kAxis.unitOrthogonal();
  for (const double angle : {0.0, 1e-9, 0.5, 2.0, 3.141592}) {
    const Vector3d turned = exp_so3(angle * kAxis) * side;
    EXPECT_NEAR(angle_between(3.0 * side, 0.2 * turned), angle, 1e-15 + 1e-15 * angle) << angle;
  }
  EXPECT_EQ(angle_between(Vector3d::Zero(), side), 0.0);
}

TEST(AlignSign, ReturnsTheNearerOfTwoQuaternions) {
  const Eigen::Quaterniond q = exp_so3(Eigen::Vector3d(0.3, -0.2, 0.1));
  Eigen::Quaterniond near = q, far = q;
  far.coeffs() = -far.coeffs();
  align_sign(Eigen::Quaterniond::Identity().coeffs(), near.coeffs());
  align_sign(Eigen::Quaterniond::Identity().coeffs(), far.coeffs());
  EXPECT_EQ(near.coeffs(), q.coeffs());
  EXPECT_EQ(far.coeffs(), q.coeffs());
}

}  // namespace
}  // namespace retarget
