#include "base/math/uniform_spline.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "retarget/so3.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

std::vector<Quaterniond> wandering(int count, double step) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Quaterniond> rotations = {Quaterniond(0.1, 0.7, -0.2, 0.3).normalized()};
  for (int i = 1; i < count; ++i) {
    const Vector3d turn(normal(random), normal(random), normal(random));
    rotations.push_back(rotations.back() * exp_so3(step * turn));
  }
  return rotations;
}

TEST(RotationSplineOfMotions, GoesThroughTheSamplesWithOneVelocityAndAcceleration) {
  for (const double step : {0.01, 0.1, 0.6}) {
    const auto rotations = wandering(12, step);
    const RotationSpline spline(rotations);
    for (int i = 1; i + 1 < 12; ++i) {
      const RotationState before = spline.at(i - 1, 1.0), after = spline.at(i, 0.0);
      EXPECT_LT(log_so3(rotations[i].conjugate() * before.rotation).norm(), 1e-12);
      EXPECT_LT(log_so3(rotations[i].conjugate() * after.rotation).norm(), 1e-12);
      EXPECT_LT((before.velocity - after.velocity).norm(), 1e-12) << step;
      EXPECT_LT((before.acceleration - after.acceleration).norm(), 1e-11) << step;
    }
  }
}

TEST(RotationSplineOfMotions, VelocityAndAccelerationAreDerivatives) {
  constexpr double kStep = 1e-4;
  const RotationSpline spline(wandering(8, 0.5));
  for (int i = 0; i + 1 < 8; ++i) {
    for (const double s : {0.1, 0.5, 0.9}) {
      const RotationState at = spline.at(i, s);
      const RotationState before = spline.at(i, s - kStep), after = spline.at(i, s + kStep);
      const Vector3d velocity =
          log_so3(before.rotation.conjugate() * after.rotation) / (2.0 * kStep);
      const Vector3d acceleration = (after.velocity - before.velocity) / (2.0 * kStep);
      EXPECT_LT((velocity - at.velocity).norm(), 1e-6);
      EXPECT_LT((acceleration - at.acceleration).norm(), 1e-5);
    }
  }
}

TEST(RotationSplineOfMotions, KeepsAConstantAngularVelocity) {
  const Vector3d turn(0.2, -0.3, 0.1);
  std::vector<Quaterniond> rotations = {Quaterniond(0.5, 0.5, 0.5, 0.5)};
  for (int i = 1; i < 7; ++i) rotations.push_back(rotations.back() * exp_so3(turn));
  for (Quaterniond& q : rotations) q.coeffs() *= q.x() > 0.3 ? -1.0 : 1.0;
  const RotationSpline spline(rotations);
  for (int i = 0; i + 1 < 7; ++i) {
    const RotationState at = spline.at(i, 0.3);
    EXPECT_LT((at.velocity - turn).norm(), 1e-13);
    EXPECT_LT(at.acceleration.norm(), 1e-13);
  }
}

// About one axis it is the cubic spline of the angle, with the velocities of the clamped spline.
TEST(RotationSplineOfMotions, IsTheCubicSplineOfTheAngleAboutOneAxis) {
  const Vector3d axis = Vector3d(1, 2, -2) / 3.0;
  const std::vector<double> angles = {0.0, 0.3, 0.35, -0.2, 0.1, 0.6};
  std::vector<Quaterniond> rotations;
  for (const double angle : angles) rotations.push_back(exp_so3(angle * axis));
  const RotationSpline spline(rotations);
  // v[i-1] + 4 v[i] + v[i+1] = 3 (angle[i+1] - angle[i-1])
  for (int i = 1; i + 1 < 6; ++i) {
    const auto velocity = [&](int k) {
      return (k < 5 ? spline.at(k, 0.0) : spline.at(4, 1.0)).velocity.dot(axis);
    };
    EXPECT_NEAR(velocity(i - 1) + 4.0 * velocity(i) + velocity(i + 1),
                3.0 * (angles[i + 1] - angles[i - 1]), 1e-12);
  }
}

TEST(RotationSplineOfMotions, KeepsAConstantAngularAccelerationToItsEnds) {
  const Vector3d axis = Vector3d(2, -1, 2) / 3.0;
  std::vector<Quaterniond> rotations;
  for (int i = 0; i < 8; ++i) rotations.push_back(exp_so3(0.02 * i * i * axis));
  const RotationSpline spline(rotations);
  for (int i = 0; i + 1 < 8; ++i) {
    for (const double s : {0.0, 0.4, 1.0}) {
      const RotationState at = spline.at(i, s);
      EXPECT_LT((at.velocity - 0.04 * (i + s) * axis).norm(), 1e-12);
      EXPECT_LT((at.acceleration - 0.04 * axis).norm(), 1e-11);
    }
  }
}

TEST(RotationSplineOfMotions, HandlesOneAndTwoSamples) {
  const RotationSpline one(std::vector<Quaterniond>{Quaterniond(0, 1, 0, 0)});
  EXPECT_EQ(one.at(0, 0.5).velocity.norm(), 0.0);
  EXPECT_EQ(one.at(0, 0.5).rotation.x(), 1.0);
  const RotationSpline two(
      std::vector<Quaterniond>{Quaterniond::Identity(), exp_so3({0.4, 0.0, 0.0})});
  EXPECT_NEAR(two.at(0, 0.5).rotation.x(), exp_so3({0.2, 0.0, 0.0}).x(), 1e-15);
  EXPECT_NEAR(two.at(0, 0.5).velocity.x(), 0.4, 1e-15);
}

// For rotations so small that they add like vectors, the spline is linear in their size. The
// reference is 1e-4 rad, where this holds to 1e-4; quaternions represent rotations of 1e-9 rad to
// 1e-7.
TEST(RotationSplineOfMotions, DerivativesOfSmallNoiseScaleWithItsSize) {
  const double measure = 1e-4;
  const RotationSpline larger(wandering(20, measure));
  for (const double size : {1e-6, 1e-7, 1.5e-8, 1e-8, 3e-9, 1e-9}) {
    const RotationSpline spline(wandering(20, size));
    for (int i = 0; i + 1 < 20; ++i) {
      for (const double s : {0.0, 0.5, 1.0}) {
        const RotationState at = spline.at(i, s), wanted = larger.at(i, s);
        const double share = size / measure, tolerance = 1e-3 + 1e-14 / size;
        EXPECT_LT((at.velocity / share - wanted.velocity).norm(), tolerance * measure) << size;
        EXPECT_LT((at.acceleration / share - wanted.acceleration).norm(), 10 * tolerance * measure)
            << size;
      }
    }
  }
}

}  // namespace
}  // namespace retarget
