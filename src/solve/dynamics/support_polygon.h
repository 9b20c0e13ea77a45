#pragma once

#include <Eigen/Core>
#include <vector>

namespace retarget {

/// Signed distance of a point inside the convex hull of some points to the hull's edge, metres;
/// negative outside. For one or two points, which enclose nothing, minus the distance to them.
/// @param points  at least one; modified.
[[nodiscard]] double margin_in_hull(const Eigen::Vector2d& point,
                                    std::vector<Eigen::Vector2d>& points);

}  // namespace retarget
