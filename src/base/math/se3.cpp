#include "base/math/se3.h"

#include <cmath>

#include "retarget/trigonometry.h"

namespace retarget {
namespace {

// Squared angle below which the limit replaces the closed form, as in the published method. The
// limit neglects 1e-10 / 720 of 1 / 12, times |w|^2 = 1e-10. The closed form loses 2e-16 to
// rounding, all of which remains in the product with W^2.
constexpr double kSmallAngleSquared = 1e-10;

}  // namespace

Vector6d log_se3(const Pose& a_from_b) {
  const Eigen::Vector3d w = log_so3(a_from_b.rotation);
  const double angle_squared = w.squaredNorm();
  const Eigen::Matrix3d W = skew(w);
  Eigen::Matrix3d V_inverse = Eigen::Matrix3d::Identity() - 0.5 * W;
  if (angle_squared < kSmallAngleSquared) {
    V_inverse += W * W / 12.0;
  } else {
    const double angle = std::sqrt(angle_squared);
    const double half = 0.5 * angle;
    const auto [sine, cosine] = portable::sin_cos(half);
    V_inverse += (1.0 - half * cosine / sine) / angle_squared * (W * W);
  }
  Vector6d twist;
  twist << V_inverse * a_from_b.translation, w;
  return twist;
}

}  // namespace retarget
