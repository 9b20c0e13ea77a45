#include "math/se3.h"

#include <cmath>

#include "math/so3.h"
#include "math/trigonometry.h"

namespace retarget {
namespace {

// squared angle below which the published method changes from closed forms to their limits
constexpr double kSmallSquaredAngleSquared = 1e-10;
constexpr double kSmallSquaredAngle = 1e-10;

// the block that couples rotation into translation in the left Jacobian of SE(3),
// Q(v, w) of Barfoot's eq. 7.86, for angles that are not small
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

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return matrix;
}

Vector6d log_se3(const Pose& a_from_b) {
  const Eigen::Vector3d w = log_so3(a_from_b.rotation);
  const double angle_squared = w.squaredNorm();
  const Eigen::Matrix3d W = skew(w);
  Eigen::Matrix3d V_inverse = Eigen::Matrix3d::Identity() - 0.5 * W;
  if (angle_squared < kSmallSquaredAngleSquared) {
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

Eigen::Matrix3d left_jacobian_inverse_so3(const Eigen::Vector3d& w) {
  const double angle_squared = w.squaredNorm();
  const double angle = std::sqrt(angle_squared);
  const auto [sine, cosine] = portable::sin_cos(angle);
  const double beta = angle < kSmallSquaredAngle
                          ? 1.0 / 12.0
                          : (1.0 - angle * sine / (2.0 * (1.0 - cosine))) / angle_squared;
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() - 0.5 * W + beta * (W * W);
}

Matrix6d left_jacobian_inverse_se3(const Vector6d& x) {
  Matrix6d inverse = Matrix6d::Identity();
  const Eigen::Vector3d w = x.tail<3>();
  if (w.squaredNorm() < kSmallSquaredAngleSquared) return inverse;
  const Eigen::Matrix3d rotation = left_jacobian_inverse_so3(w);
  inverse.topLeftCorner<3, 3>() = rotation;
  inverse.bottomRightCorner<3, 3>() = rotation;
  inverse.topRightCorner<3, 3>() = -rotation * coupling_block(x.head<3>(), w) * rotation;
  return inverse;
}

}  // namespace retarget
