#include "base/math/convex_hull.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace retarget {

void reduce_to_hull(std::vector<Eigen::Vector2d>& points) {
  std::ranges::sort(points, [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return;
  std::vector<Eigen::Vector2d> hull;
  const auto add_chain = [&hull](auto begin, auto end) {
    const std::size_t base = hull.size();
    for (auto at = begin; at != end; ++at) {
      while (hull.size() >= base + 2 &&
             cross_2d(hull.back() - hull[hull.size() - 2], *at - hull.back()) <= 0.0) {
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

}  // namespace retarget
