#pragma once

#include <Eigen/Core>
#include <vector>

namespace retarget {

/// How far inside the convex hull of some points a point is: the distance to its edge, negative
/// outside. Of one or two points, which enclose nothing, minus the distance.
/// @param points  at least one; brought into an order of its own.
[[nodiscard]] double margin_in_hull(const Eigen::Vector2d& point,
                                    std::vector<Eigen::Vector2d>& points);

}  // namespace retarget
