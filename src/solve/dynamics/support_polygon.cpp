#include "solve/dynamics/support_polygon.h"

#include <algorithm>
#include <limits>

namespace retarget {
namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Andrew's monotone chain: replaces the points by the corners of their hull, counterclockwise.
void reduce_to_hull(std::vector<Vector2d>& points) {
  std::ranges::sort(points, [](const Vector2d& a, const Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return;
  std::vector<Vector2d> hull;
  const auto add_chain = [&hull](auto begin, auto end) {
    const std::size_t base = hull.size();
    for (auto at = begin; at != end; ++at) {
      while (hull.size() >= base + 2 &&
             cross(hull.back() - hull[hull.size() - 2], *at - hull.back()) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(*at);
    }
    hull.pop_back();  // The next chain starts with this point.
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  points = std::move(hull);
}

}  // namespace

double margin_in_hull(const Vector2d& point, std::vector<Vector2d>& points) {
  // Non-finite values have no order and cannot be sorted.
  std::erase_if(points, [](const Vector2d& each) { return !each.allFinite(); });
  reduce_to_hull(points);
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = points.size() > 2;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector2d& from = points[i];
    const Vector2d edge = points[(i + 1) % points.size()] - from;
    const double length = edge.squaredNorm();
    const double along =
        length > 0.0 ? std::clamp((point - from).dot(edge) / length, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (from + along * edge - point).norm());
    inside = inside && cross(edge, point - from) >= 0.0;
  }
  return inside ? nearest : -nearest;
}

}  // namespace retarget
