#pragma once

#include <algorithm>

namespace retarget {

/// The point of a segment that is nearest to another point; a segment without length is a point.
/// @tparam Vector  Eigen::Vector2d or Eigen::Vector3d
template <typename Vector>
[[nodiscard]] Vector nearest_on_segment(const Vector& point, const Vector& a, const Vector& b) {
  const Vector along = b - a;
  const double square = along.squaredNorm();
  if (!(square > 0.0)) return a;
  return a + std::clamp((point - a).dot(along) / square, 0.0, 1.0) * along;
}

}  // namespace retarget
