#pragma once

#include <cmath>
#include <random>

#include "base/math/se3.h"
#include "retarget/so3.h"
#include "retarget/trigonometry.h"

namespace retarget {

/// The rigid transform reached by moving with a constant twist for one unit of time.
/// Inverse of log_se3 for angles below pi.
inline Pose exp_se3(const Vector6d& twist) {
  const Eigen::Vector3d w = twist.tail<3>();
  const double angle_squared = w.squaredNorm();
  const Eigen::Matrix3d W = skew(w);
  Eigen::Matrix3d V;
  if (angle_squared < 1e-10) {
    V = Eigen::Matrix3d::Identity() + 0.5 * W + W * W / 6.0;
  } else {
    const double angle = std::sqrt(angle_squared);
    const auto [sine, cosine] = portable::sin_cos(angle);
    V = Eigen::Matrix3d::Identity() + (1.0 - cosine) / angle_squared * W +
        (angle - sine) / (angle_squared * angle) * (W * W);
  }
  return {exp_so3(w), V * twist.head<3>()};
}

/// Random twists, the same in every run.
class RandomTwists {
 public:
  /// A twist with this angle of rotation, rad.
  Vector6d next(double angle) {
    Vector6d twist;
    for (int i = 0; i < 6; ++i) twist[i] = uniform_(engine_);
    twist.tail<3>() *= angle / twist.tail<3>().norm();
    return twist;
  }

 private:
  std::mt19937 engine_{7};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

}  // namespace retarget
