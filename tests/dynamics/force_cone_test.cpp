// Projections onto cones of contact forces: the conditions of optimality, and closed forms.

#include "solve/dynamics/force_cone.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <random>

#include "retarget/so3.h"

namespace retarget {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

ForceCone two_feet(double friction = 0.6) {
  ForceCone cone;
  cone.clear();
  for (const double x : {-0.2, 0.3}) {
    for (const double y : {-0.5, -0.3, 0.3, 0.5}) cone.add_point({x, y, -2.0}, friction);
  }
  return cone;
}

Vector6d wrench(const Vector3d& force, const Vector3d& torque) {
  Vector6d wrench;
  wrench << force, torque;
  return wrench;
}

TEST(ForceCone, ResidualIsZeroForForcesInTheCone) {
  ForceCone cone = two_feet();
  ConeProjector projector;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> amount(0.0, 0.2);
  for (int round = 0; round < 50; ++round) {
    Vector6d inside = Vector6d::Zero();
    for (int i = 0; i < cone.edges().cols(); ++i) inside += amount(random) * cone.edges().col(i);
    EXPECT_LT(projector.project(cone, inside).norm(), 1e-4);
  }
}

// The residual to the nearest point of a cone is orthogonal to that point and makes no acute angle
// with any edge.
TEST(ForceCone, ResidualSatisfiesTheConditionsOfTheNearestPoint) {
  ConeProjector projector;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  ForceCone cone = two_feet();
  for (int round = 0; round < 200; ++round) {
    Vector6d given;
    for (double& value : given) value = normal(random);
    const Vector6d rest = projector.project(cone, given);
    EXPECT_NEAR(rest.dot(given - rest), 0.0, 2e-5);
    EXPECT_LT((cone.edges().transpose() * rest).maxCoeff(), 2e-5);
    // A cold start gives the same result.
    ForceCone fresh = two_feet();
    EXPECT_LT((projector.project(fresh, given) - rest).norm(), 1e-4);
  }
}

// The amounts of an earlier projection are one way to supply a wrench; the nearest point is the
// best way.
TEST(ForceCone, ExplainsOnlyWhatTheConeCanSupply) {
  ConeProjector projector;
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  ForceCone cone = two_feet();
  constexpr double kRest = 0.06;
  int explained = 0, unknown = 0;
  Vector6d given = wrench({0.0, 0.0, 1.0}, Vector3d::Zero());
  for (int round = 0; round < 500; ++round) {
    for (double& value : given) value += 0.01 * normal(random);
    if (ConeProjector::explains(cone, given, kRest)) {
      ForceCone fresh = two_feet();
      EXPECT_LE(projector.project(fresh, given).norm(), kRest + 1e-6);
      ++explained;
    } else {
      projector.project(cone, given);
      ++unknown;
    }
  }
  EXPECT_GT(explained, 50);
  EXPECT_GT(unknown, 50);
  given[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(ConeProjector::explains(cone, given, kRest));
}

TEST(ForceCone, PyramidsLieInTheConeAboutTheirNormal) {
  constexpr double kFriction = 0.7;
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 50; ++round) {
    const Vector3d n = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const auto edges = friction_pyramid(kFriction, n);
    for (int i = 0; i < edges.cols(); ++i) {
      EXPECT_NEAR(edges.col(i).dot(n), 1.0, 1e-12);
      EXPECT_NEAR((edges.col(i) - n).norm(), kFriction, 1e-12);
    }
    EXPECT_LT((edges.rowwise().sum() - 4.0 * n).norm(), 1e-12);
    EXPECT_NEAR((edges.col(0) - n).dot(edges.col(2) - n), 0.0, 1e-12);
  }
}

Vector3d base_forward(const Quaterniond& world_from_base) {
  return turn_about_vertical(world_from_base) * Vector3d::UnitX();
}

// A turn of the world about the vertical turns the heading and the pyramids.
TEST(ForceCone, PyramidsTurnWithTheBase) {
  std::mt19937 random(4);
  std::normal_distribution<double> number;
  const auto direction = [&] {
    return Vector3d(number(random), number(random), number(random)).normalized();
  };
  for (int round = 0; round < 50; ++round) {
    const Quaterniond base(AngleAxisd(2.0 * number(random), direction()));
    const Quaterniond turn(AngleAxisd(number(random), Vector3d::UnitZ()));
    const Vector3d forward = base_forward(base), turned = base_forward(turn * base);
    EXPECT_LT((turned - turn * forward).norm(), 1e-9);
    EXPECT_NEAR(forward.norm(), 1.0, 1e-12);
    EXPECT_EQ(forward.z(), 0.0);
    for (const Vector3d& normal : {Vector3d(Vector3d::UnitZ()), direction()}) {
      const auto edges = friction_pyramid(0.8, normal, forward);
      const auto after = friction_pyramid(0.8, turn * normal, turned);
      EXPECT_LT((after - turn.toRotationMatrix() * edges).norm(), 1e-9);
    }
  }
  EXPECT_EQ(base_forward(Quaterniond(0.0, 1.0, 0.0, 0.0)), Vector3d(Vector3d::UnitX()));
}

TEST(ForceCone, ContactsNeverPull) {
  ForceCone cone = two_feet();
  ConeProjector projector;
  const Vector6d down = wrench({0, 0, -1}, Vector3d::Zero());
  EXPECT_LT((projector.project(cone, down) - down).norm(), 1e-12);
  ForceCone none;
  none.clear();
  const Vector6d up = wrench({0, 0, 1}, Vector3d::Zero());
  EXPECT_EQ(projector.project(none, up), up);
  EXPECT_EQ(projector.complement(), Matrix6d::Identity());
}

// One point with a horizontal force beyond its friction: the pyramid face mu z = x is nearest.
TEST(ForceCone, FrictionIsAPyramid) {
  ForceCone cone;
  cone.clear();
  cone.add_point(Vector3d::Zero(), 0.5);
  ConeProjector projector;
  const Vector6d rest = projector.project(cone, wrench({1, 0, 1}, Vector3d::Zero()));
  // The point of (0.5, 0, 1) s nearest to (1, 0, 1).
  const Vector3d edge(0.5, 0, 1);
  const Vector3d nearest = edge * (1.5 / edge.squaredNorm());
  EXPECT_LT((rest.head<3>() - (Vector3d(1, 0, 1) - nearest)).norm(), 1e-4);
}

TEST(ForceCone, ComplementIsTheDerivativeOfTheResidual) {
  constexpr double kStep = 1e-5;
  ConeProjector projector;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  int compared = 0;
  for (int round = 0; round < 40; ++round) {
    Vector6d given, way;
    for (double& value : given) value = normal(random);
    for (double& value : way) value = normal(random);
    ForceCone cone = two_feet();
    const Vector6d rest = projector.project(cone, given);
    const Matrix6d complement = projector.complement();
    const Vector6d after = projector.project(cone, given + kStep * way);
    const Matrix6d complement_after = projector.complement();
    // Avoids kinks of the projection.
    if ((complement - complement_after).norm() > 1e-6) continue;
    ++compared;
    EXPECT_LT(((after - rest) / kStep - complement * way).norm(), 2e-3 * way.norm());
  }
  EXPECT_GT(compared, 20);
}

}  // namespace
}  // namespace retarget
