#include "solve/ik/published_jacobian.h"

#include <cmath>

#include "retarget/trigonometry.h"

namespace retarget {
namespace {

// The block Q(v, w) of the left Jacobian of SE(3), which couples rotation into translation
// (Barfoot, eq. 7.86). Inaccurate for small angles.
Eigen::Matrix3d coupling_block(const Eigen::Vector3d& v, const Eigen::Vector3d& w) {
  const double angle_squared = w.squaredNorm();
  const double angle = std::sqrt(angle_squared);
  const auto [sine, cosine] = portable::sin_cos(angle);
  const double fourth = angle_squared * angle_squared;
  const double b = (angle - sine) / (angle_squared * angle);
  const double c = (1.0 - 0.5 * angle_squared - cosine) / fourth;
  const double d = (2.0 * angle - 3.0 * sine + angle * cosine) / (2.0 * fourth * angle);

  const Eigen::Matrix3d V = skew(v);
  const Eigen::Matrix3d W = skew(w);
  const Eigen::Matrix3d VW = V * W;
  const Eigen::Matrix3d WV = VW.transpose();
  const Eigen::Matrix3d WVW = WV * W;
  const Eigen::Matrix3d VWW = VW * W;
  return 0.5 * V + b * (WV + VW + WVW) - c * (VWW - VWW.transpose() - 3.0 * WVW) +
         d * (WVW * W + W * WVW);
}

// Inverse left Jacobian of SO(3). Inaccurate for small angles.
Eigen::Matrix3d rotation_block(const Eigen::Vector3d& w) {
  const double angle_squared = w.squaredNorm();
  const double angle = std::sqrt(angle_squared);
  const auto [sine, cosine] = portable::sin_cos(angle);
  const double beta = (1.0 - angle * sine / (2.0 * (1.0 - cosine))) / angle_squared;
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() - 0.5 * W + beta * (W * W);
}

}  // namespace

Matrix6d published_jacobian_inverse(const Vector6d& x) {
  constexpr double kIdentityBelow = 1e-10;
  Matrix6d inverse = Matrix6d::Identity();
  const Eigen::Vector3d w = x.tail<3>();
  if (w.squaredNorm() < kIdentityBelow) return inverse;
  const Eigen::Matrix3d rotation = rotation_block(w);
  inverse.topLeftCorner<3, 3>() = rotation;
  inverse.bottomRightCorner<3, 3>() = rotation;
  inverse.topRightCorner<3, 3>() = -rotation * coupling_block(x.head<3>(), w) * rotation;
  return inverse;
}

}  // namespace retarget
