#include "robot/anatomy/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "retarget/shape_distance.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

// Points on the side of a cylinder.
void add_cylinder(const Vector3d& from, const Vector3d& to, double radius, Points& points) {
  const Vector3d axis = (to - from).normalized();
  const Vector3d side = axis.unitOrthogonal(), other = axis.cross(side);
  for (double along = 0.0; along <= (to - from).norm() + 1e-9; along += 0.01) {
    for (int i = 0; i < 24; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / 24;
      points.push_back(from + along * axis +
                       radius * (std::cos(angle) * side + std::sin(angle) * other));
    }
  }
}

double distance_from(const Vector3d& point, const std::vector<CollisionShape>& shapes) {
  CollisionShape ball;
  ball.body_from_shape.translation = point;
  double nearest = INFINITY;
  for (const CollisionShape& shape : shapes) {
    nearest = std::min(nearest, shape_distance(rounded(ball), rounded(shape)).distance);
  }
  return nearest;
}

double farthest_outside(const Points& points, const std::vector<CollisionShape>& shapes) {
  double farthest = 0.0;
  for (const Vector3d& point : points) farthest = std::max(farthest, distance_from(point, shapes));
  return farthest;
}

TEST(Capsules, FindsATiltedRod) {
  Points points;
  const Vector3d from(0.1, 0.05, 0.02), to(0.2, -0.1, 0.35);
  add_cylinder(from, to, 0.03, points);
  const auto shapes = capsules_around(3, points);
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_EQ(shapes[0].body, 3);
  EXPECT_EQ(shapes[0].type, CollisionShape::Type::kCapsule);
  EXPECT_NEAR(shapes[0].radius, 0.03, 0.003);
  EXPECT_LT((shapes[0].body_from_shape.translation - 0.5 * (from + to)).norm(), 0.01);
  const Vector3d axis = shapes[0].body_from_shape.rotation * Vector3d::UnitZ();
  EXPECT_GT(std::abs(axis.dot((to - from).normalized())), 0.999);
  EXPECT_LT(farthest_outside(points, shapes), 0.003);
}

// A hip: a thick motor across the top of a slender leg. A single shape would be as wide as the
// motor all the way down.
TEST(Capsules, SplitsAThigh) {
  Points points;
  add_cylinder({0, -0.12, 0}, {0, 0.12, 0}, 0.06, points);
  add_cylinder({0, 0, 0}, {0, 0, -0.4}, 0.04, points);
  const auto shapes = capsules_around(1, points);
  EXPECT_GE(shapes.size(), 2U);
  EXPECT_LE(shapes.size(), 3U);
  EXPECT_LT(farthest_outside(points, shapes), 0.02);
  double sum = 0.0;
  for (const CollisionShape& shape : shapes) sum += volume(shape);
  const double truth = std::numbers::pi * (0.06 * 0.06 * 0.24 + 0.04 * 0.04 * 0.34);
  EXPECT_LT(sum, 1.8 * truth);
  // Half way down, the space next to the leg is empty.
  EXPECT_GT(distance_from({0, 0.09, -0.25}, shapes), 0.02);
}

TEST(Capsules, AcceptsAnyPoints) {
  for (const Points& points :
       {Points{{0, 0, 0}}, Points{{0, 0, 0}, {0, 0, 0.1}}, Points(20, Vector3d(1, 2, 3))}) {
    const auto shapes = capsules_around(1, points);
    ASSERT_FALSE(shapes.empty());
    for (const CollisionShape& shape : shapes) {
      EXPECT_GT(shape.radius, 0.0);
      EXPECT_TRUE(shape.body_from_shape.translation.allFinite());
      EXPECT_TRUE(shape.body_from_shape.rotation.coeffs().allFinite());
    }
    EXPECT_LT(farthest_outside(points, shapes), 1e-3);
  }
}

TEST(Capsules, ThinningKeepsOnePointPerCell) {
  const Points points = {{0, 0, 0}, {0.001, 0, 0}, {0.02, 0, 0}, {0, 0.002, 0}, {0.02, 0, 0}};
  const Points kept = thinned(points, 0.01);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0], points[0]);
  EXPECT_EQ(kept[1], points[2]);
}

}  // namespace
}  // namespace retarget
