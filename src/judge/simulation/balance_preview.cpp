#include "judge/simulation/balance_preview.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/math/convex_hull.h"

namespace retarget {

using Eigen::Vector2d;

Vector2d nearest_in_support(const Vector2d& point, std::vector<Vector2d> support, double share) {
  if (support.empty()) return point;
  reduce_to_hull(support);
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& corner : support) middle += corner;
  middle /= static_cast<double>(support.size());
  for (Vector2d& corner : support) corner = middle + share * (corner - middle);
  bool inside = support.size() > 2;
  double nearest = std::numeric_limits<double>::infinity();
  Vector2d best = point;
  for (std::size_t i = 0; i < support.size(); ++i) {
    const Vector2d& from = support[i];
    const Vector2d edge = support[(i + 1) % support.size()] - from;
    const double length = edge.squaredNorm();
    const double along =
        length > 0.0 ? std::clamp((point - from).dot(edge) / length, 0.0, 1.0) : 0.0;
    const Vector2d at = from + along * edge;
    inside = inside && cross_2d(edge, point - from) >= 0.0;
    if ((at - point).squaredNorm() >= nearest) continue;
    nearest = (at - point).squaredNorm();
    best = at;
  }
  return inside ? point : best;
}

// A tridiagonal system, diagonally dominant: elimination without pivots.
std::vector<Vector2d> balancing_shift(const std::vector<BalanceSample>& samples, double time_step,
                                      double share) {
  std::vector<Vector2d> shift(samples.size(), Vector2d::Zero());
  if (samples.size() < 3) return shift;
  std::vector<double> upper(samples.size(), 0.0);
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const BalanceSample& each = samples[i];
    const double pull = std::max(0.0, each.pull) * time_step * time_step;
    const Vector2d moved = nearest_in_support(each.zmp, each.support, share) - each.zmp;
    // Row i: -x[i-1] + (2 + pull) x[i] - x[i+1] = pull * moved.
    const double pivot = 2.0 + pull - upper[i - 1];
    upper[i] = 1.0 / pivot;
    shift[i] = (pull * moved + shift[i - 1]) / pivot;
  }
  for (std::size_t i = samples.size() - 2; i > 0; --i) shift[i] += upper[i] * shift[i + 1];
  return shift;
}

}  // namespace retarget
