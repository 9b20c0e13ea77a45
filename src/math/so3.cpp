#include "math/so3.h"

#include <cmath>

#include "math/trigonometry.h"

namespace retarget {
namespace {

// angle in rad below which series take the place of closed forms
constexpr double kSmallAngle = 1e-4;

// of q and -q the one in the upper half; on its rim, where the scalar part is zero, the one
// whose first non-zero component is positive
bool is_lower_half(const Eigen::Quaterniond& q) {
  if (q.w() != 0.0) return q.w() < 0.0;
  if (q.x() != 0.0) return q.x() < 0.0;
  if (q.y() != 0.0) return q.y() < 0.0;
  return q.z() < 0.0;
}

}  // namespace

Eigen::Quaterniond exp_so3(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const auto [sine, cosine] = portable::sin_cos(0.5 * angle);
  const double vector_per_angle = angle < kSmallAngle ? 0.5 - angle * angle / 48.0 : sine / angle;
  const Eigen::Vector3d vector = vector_per_angle * w;
  return {cosine, vector.x(), vector.y(), vector.z()};
}

Eigen::Vector3d log_so3(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  const double cosine = std::abs(q.w());
  double angle_per_vector = 0.0;
  if (sine < 0.5 * kSmallAngle * cosine) {
    const double tangent = sine / cosine;
    angle_per_vector = 2.0 / cosine * (1.0 - tangent * tangent / 3.0);
  } else {
    angle_per_vector = 2.0 * portable::atan2(sine, cosine) / sine;
  }
  const Eigen::Vector3d w = angle_per_vector * q.vec();
  return is_lower_half(q) ? Eigen::Vector3d(-w) : w;
}

Eigen::Vector3d apply_left_jacobian_inverse_so3(const Eigen::Vector3d& w,
                                                const Eigen::Vector3d& v) {
  const double angle = w.norm();
  // (1 - x/2 cot(x/2)) / x^2, by its series where the difference would cancel
  double second = 1.0 / 12.0;
  if (angle < 0.03) {
    const double square = angle * angle;
    second += square / 720.0 + square * square / 30240.0;
  } else {
    const auto [sine, cosine] = portable::sin_cos(0.5 * angle);
    second = (1.0 - 0.5 * angle * cosine / sine) / (angle * angle);
  }
  const Eigen::Vector3d cross = w.cross(v);
  return v - 0.5 * cross + second * w.cross(cross);
}

Eigen::Quaterniond rotation_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return Eigen::Quaterniond::FromTwoVectors(a, b);
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return portable::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace retarget
