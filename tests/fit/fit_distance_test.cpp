// Distances of rounded shapes in the fit, with continuously changing nearest points: closed forms,
// and many sampled points for the other shapes.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "retarget/shape_distance.h"
#include "retarget/so3.h"
#include "solve/fit/fit_model.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

RoundedShape shape(std::vector<Vector3d> axes, double radius, const Vector3d& centre = {0, 0, 0}) {
  RoundedShape result;
  result.centre = centre;
  result.radius = radius;
  for (const Vector3d& axis : axes) {
    result.half_axes[static_cast<std::size_t>(result.axis_count++)] = axis;
  }
  return result;
}

// Seen from b: the normal points to a; points lie on the cores and coincide where they meet.
struct FitDistance {
  double distance;
  Vector3d normal, on_a, on_b;
};

FitDistance fit_distance(const RoundedShape& a, const Pose& world_from_a, const RoundedShape& b,
                         const Pose& world_from_b) {
  const ShapeDistance found =
      shape_distance(placed(a, world_from_a), placed(b, world_from_b), NearestPoints::kEven);
  FitDistance result{found.distance, -found.normal, found.on_a - a.radius * found.normal,
                     found.on_b + b.radius * found.normal};
  if (found.distance + a.radius + b.radius < 0.0) {
    result.on_a = result.on_b = 0.5 * (result.on_a + result.on_b);
  }
  return result;
}

Pose moved(const Vector3d& by) {
  return {Eigen::Quaterniond::Identity(), by};
}

TEST(FitDistance, SphereSphere) {
  const auto found =
      fit_distance(shape({}, 0.1), moved({0, 0, 0}), shape({}, 0.2), moved({1, 0, 0}));
  EXPECT_NEAR(found.distance, 0.7, 1e-15);
  EXPECT_TRUE(found.normal.isApprox(Vector3d(-1, 0, 0)));
}

TEST(FitDistance, HandlesCrossedCapsules) {
  const auto found = fit_distance(shape({{1, 0, 0}}, 0.1), moved({0.3, 0, 0}),
                                  shape({{0, 1, 0}}, 0.2), moved({0, 0.4, -0.25}));
  EXPECT_NEAR(found.distance, -0.05, 1e-15);
  EXPECT_TRUE(found.on_a.isApprox(Vector3d(1e-300, 0, 0), 1e-12) || found.on_a.norm() < 1e-12);
  EXPECT_TRUE(found.normal.isApprox(Vector3d(0, 0, 1)));
}

TEST(FitDistance, CapsuleEndPlate) {
  const auto found = fit_distance(shape({{0, 0, 0.5}}, 0.1), moved({0.2, 0.1, 1.0}),
                                  shape({{0.4, 0, 0}, {0, 0.3, 0}}, 0.05), moved({0, 0, 0}));
  EXPECT_NEAR(found.distance, 0.5 - 0.15, 1e-12);
}

TEST(FitDistance, CrossingLinesSeparatePerpendicularly) {
  const auto found = fit_distance(shape({{1, 0, 0}}, 0.1), moved({0, 0.5, 0}),
                                  shape({{0, 1, 0}}, 0.2), moved({0, 0, 0}));
  EXPECT_NEAR(found.distance, -0.3, 1e-9);
  EXPECT_NEAR(std::abs(found.normal.z()), 1.0, 1e-12);
}

TEST(FitDistance, BoxInsideBoxUsesTheShortestSeparation) {
  // They overlap by 0.3 of two metres along x, more along y and z.
  const auto found =
      fit_distance(shape({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 0.05), moved({1.7, 0.2, 0}),
                   shape({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 0.05), moved({0, 0, 0}));
  EXPECT_NEAR(found.distance, -0.4, 1e-12);
  EXPECT_TRUE(found.normal.isApprox(Vector3d(1, 0, 0)));
}

// Movement of the nearest points for a small rotation of a.
double move_of_points(const RoundedShape& a, const RoundedShape& b, const Vector3d& between,
                      const Vector3d& from, const Vector3d& to) {
  const auto distance = [&](const Vector3d& turn) {
    const Pose at_a{exp_so3(turn), between};
    return fit_distance(a, at_a, b, moved(Vector3d::Zero()));
  };
  const FitDistance one = distance(from), other = distance(to);
  EXPECT_NEAR(one.distance, other.distance, 1e-6);
  return std::max((one.on_a - other.on_a).norm(), (one.on_b - other.on_b).norm());
}

TEST(FitDistance, NearParallelShapesAreStableToRounding) {
  // Two overlapping feet, one 2 cm ahead.
  const RoundedShape foot = shape({{0.1, 0, 0}, {0, 0.04, 0}, {0, 0, 0.02}}, 0.008);
  const Vector3d bits(1e-9, 1.5e-9, 2e-9);
  EXPECT_LT(move_of_points(foot, foot, {0.02, 0.075, 0.0}, bits, -bits), 1e-5);
  // Two shanks.
  const RoundedShape shank = shape({{0.15, 0, 0}}, 0.05);
  for (const double turn : {0.0, 1e-7, 1e-6, 1e-5, 1e-4}) {
    const Vector3d from(0.0, 0.0, 0.99 * turn), to(0.0, 0.0, 1.01 * turn + 1e-9);
    EXPECT_LT(move_of_points(shank, shank, {0.02, 0.09, 0.0}, from, to), 1e-5 + 2e3 * turn * 0.02);
  }
}

// Overlapping boxes: the exact distance, and its change according to normal and point.
TEST(FitDistance, OverlappingBoxesHaveExactDepth) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vector = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  int seen = 0;
  for (int round = 0; round < 200; ++round) {
    const Vector3d size_a(0.5, 0.3, 0.2), size_b(0.4, 0.4, 0.1);
    std::vector<Vector3d> a_axes, b_axes;
    for (int i = 0; i < 3; ++i) {
      a_axes.emplace_back(size_a[i] * Vector3d::Unit(i));
      b_axes.emplace_back(size_b[i] * Vector3d::Unit(i));
    }
    const Pose at_b = moved(Vector3d::Zero());
    Pose at_a{exp_so3(2.0 * vector()), 0.3 * vector()};
    const RoundedShape a = shape(a_axes, 0.0), b = shape(b_axes, 0.0);
    const auto found = fit_distance(a, at_a, b, at_b);
    CollisionShape box_a, box_b;
    box_a.type = box_b.type = CollisionShape::Type::kBox;
    box_a.half_size = size_a;
    box_b.half_size = size_b;
    const ShapeDistance exact = shape_distance(place(box_a, at_a), place(box_b, {}));
    if (exact.distance > -1e-3) continue;
    ++seen;
    EXPECT_NEAR(found.distance, exact.distance, 1e-9) << round;
    // A small rotation and translation of a.
    const Vector3d turn = 1e-7 * vector(), way = 1e-7 * vector();
    at_a.rotation = exp_so3(turn) * at_a.rotation;
    const Vector3d arm = found.on_a - at_a.translation;
    at_a.translation += way;
    const double change = fit_distance(a, at_a, b, at_b).distance - found.distance;
    EXPECT_NEAR(change, found.normal.dot(way + turn.cross(arm)), 1e-10) << round;
  }
  EXPECT_GT(seen, 100);
}

TEST(FitDistance, NearestPointsAreTheNearest) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vector = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  for (int round = 0; round < 60; ++round) {
    const Eigen::Matrix3d turn = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
    std::vector<Vector3d> a_axes, b_axes;
    for (int i = 0; i < round % 4; ++i) a_axes.push_back((0.2 + 0.1 * i) * turn.col(i));
    for (int i = 0; i < (round / 4) % 4; ++i) b_axes.push_back((0.5 - 0.1 * i) * Vector3d::Unit(i));
    const RoundedShape a = shape(a_axes, 0.0), b = shape(b_axes, 0.0);
    const Pose at_a = moved(2.0 * vector()), at_b = moved(vector());
    const auto found = fit_distance(a, at_a, b, at_b);
    double min = 1e9;
    for (int sample = 0; sample < 3000; ++sample) {
      Vector3d p = at_a.translation, q = at_b.translation;
      for (const auto& axis : a_axes) p += uniform(random) * axis;
      for (const auto& axis : b_axes) q += uniform(random) * axis;
      min = std::min(min, (p - q).norm());
    }
    EXPECT_LE(found.distance, min + 2e-3) << round;
    EXPECT_NEAR((found.on_a - found.on_b).norm(), std::max(found.distance, 0.0), 1e-9);
  }
}

}  // namespace
}  // namespace retarget
