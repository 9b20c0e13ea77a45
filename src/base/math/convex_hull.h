#pragma once

#include <Eigen/Core>
#include <vector>

namespace retarget {

/// The z component of the cross product of two vectors of a plane.
[[nodiscard]] inline double cross_2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Replaces points of a plane by the corners of their convex hull, counterclockwise (Andrew's monotone
/// chain). Only sorts fewer than three distinct points.
/// @pre the points are finite
void reduce_to_hull(std::vector<Eigen::Vector2d>& points);

}  // namespace retarget
