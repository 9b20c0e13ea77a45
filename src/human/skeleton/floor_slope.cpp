#include "human/skeleton/floor_slope.h"

#include <Eigen/Cholesky>

namespace retarget {

std::vector<double> without_slope(std::vector<double> heights,
                                  const std::vector<Eigen::Vector3d>& places, int up) {
  using Eigen::Vector2d;
  constexpr double kSteepest = 0.36397;  // Tangent of 20 degrees.
  // Damping: where a body stays within a tenth of its leg, a slope counts half.
  constexpr double kStays = 0.01;
  if (heights.empty() || heights.size() != places.size()) return heights;
  const auto horizontal = [&](const Eigen::Vector3d& place) {
    return Vector2d(place[(up + 1) % 3], place[(up + 2) % 3]);
  };
  const auto count = static_cast<double>(heights.size());
  Vector2d middle = Vector2d::Zero();
  double level = 0.0;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    middle += horizontal(places[i]) / count;
    level += heights[i] / count;
  }
  Eigen::Matrix2d spread = kStays * Eigen::Matrix2d::Identity();
  Vector2d rise = Vector2d::Zero();
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const Vector2d offset = horizontal(places[i]) - middle;
    spread += offset * offset.transpose() / count;
    rise += offset * (heights[i] - level) / count;
  }
  const Vector2d slope = Eigen::LLT<Eigen::Matrix2d>(spread).solve(rise);
  if (!(slope.norm() < kSteepest)) return heights;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    heights[i] -= slope.dot(horizontal(places[i]) - middle);
  }
  return heights;
}

}  // namespace retarget
