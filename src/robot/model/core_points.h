#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// Returns the corners of a box centred at the origin.
[[nodiscard]] inline std::array<Eigen::Vector3d, 8> box_corners(const Eigen::Vector3d& half_size) {
  std::array<Eigen::Vector3d, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d sign((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                               (i & 4) != 0 ? 1.0 : -1.0);
    corners[i] = half_size.cwiseProduct(sign);
  }
  return corners;
}

/// Returns the points whose convex hull, inflated by the shape's radius, is the shape; in the
/// body's frame.
[[nodiscard]] inline std::vector<Eigen::Vector3d> core_points(const CollisionShape& shape) {
  std::vector<Eigen::Vector3d> points;
  if (shape.type == CollisionShape::Type::kBox) {
    for (const Eigen::Vector3d& corner : box_corners(shape.half_size)) {
      points.push_back(shape.body_from_shape * corner);
    }
  } else if (shape.type == CollisionShape::Type::kCapsule) {
    for (const double end : {-shape.half_length, shape.half_length}) {
      points.push_back(shape.body_from_shape * Eigen::Vector3d(0.0, 0.0, end));
    }
  } else {
    points.push_back(shape.body_from_shape.translation);
  }
  return points;
}

}  // namespace retarget
