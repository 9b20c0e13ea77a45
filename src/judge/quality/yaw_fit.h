#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "retarget/trigonometry.h"

namespace retarget {

/// The constant yaw that rotates vectors closest to other vectors in the least-squares sense.
class YawFit {
 public:
  /// Adds a pair of corresponding vectors.
  void add(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    sine_ += from.x() * to.y() - from.y() * to.x();
    cosine_ += from.x() * to.x() + from.y() * to.y();
  }

  /// The rotation from the vectors `from` to the vectors `to`; the identity without pairs.
  [[nodiscard]] Eigen::Quaterniond rotation() const {
    const double half = 0.5 * portable::atan2(sine_, cosine_);
    const auto [half_sine, half_cosine] = portable::sin_cos(half);
    return {half_cosine, 0.0, 0.0, half_sine};
  }

 private:
  double sine_ = 0.0, cosine_ = 0.0;
};

}  // namespace retarget
