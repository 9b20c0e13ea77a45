#include "solve/ik/frame_error.h"

#include <cmath>

#include "base/math/se3.h"
#include "retarget/trigonometry.h"

namespace retarget {

FrameError frame_error(const Pose& world_from_body, const Pose& world_from_target) {
  FrameError error;
  const Eigen::Vector3d offset = world_from_target.translation - world_from_body.translation;
  // Rotation from the body to the target in world axes, as the quaternion of q and -q with w >= 0.
  const Eigen::Quaterniond turn = world_from_target.rotation * world_from_body.rotation.conjugate();
  const double w = std::abs(turn.w());
  const double n = turn.vec().norm();
  double angle = 0.0;
  if (n >= kNoRotation) {
    angle = 2.0 * portable::atan2(n, w);
    error.angular = (std::copysign(angle, turn.w()) / n) * turn.vec();
    error.angle_squared = angle * angle;
    error.half_sine = n;
    error.half_cosine = w;
  }
  // V^-1 of the logarithm. Sine and cosine of half the angle are n and w.
  const double second = error.angle_squared < kSmallAngleSquared
                            ? 1.0 / 12.0
                            : (1.0 - 0.5 * angle * w / n) / error.angle_squared;
  const Eigen::Vector3d cross = error.angular.cross(offset);
  error.linear = offset - 0.5 * cross + second * error.angular.cross(cross);
  return error;
}

ErrorJacobian::ErrorJacobian(const FrameError& error)
    : error_(error), identity_(error.angle_squared < kSmallAngleSquared) {
  if (identity_) return;
  angle_ = std::sqrt(error.angle_squared);
  if (error.angle_squared > kPlainAngleSquared) {
    sine_ = 2.0 * error.half_sine * error.half_cosine;
    cosine_ = 1.0 - 2.0 * error.half_sine * error.half_sine;
  } else {
    const auto [sine, cosine] = portable::sin_cos(angle_);
    sine_ = sine;
    cosine_ = cosine;
  }
  beta_ = (1.0 - angle_ * sine_ / (2.0 * (1.0 - cosine_))) / error.angle_squared;
}

Eigen::Vector3d ErrorJacobian::transposed_times(const Eigen::Vector3d& v) const {
  if (identity_) return v;
  const Eigen::Vector3d cross = error_.angular.cross(v);
  return v + 0.5 * cross + beta_ * error_.angular.cross(cross);
}

// Expands (I + W/2 + beta W^2)(I - W/2 + beta W^2), using W^4 = -|w|^2 W^2.
Eigen::Matrix3d ErrorJacobian::square() const {
  if (identity_) return Eigen::Matrix3d::Identity();
  const double gamma = 2.0 * beta_ - 0.25 - beta_ * beta_ * error_.angle_squared;
  Eigen::Matrix3d square = (gamma * error_.angular) * error_.angular.transpose();
  square.diagonal().array() += 1.0 - gamma * error_.angle_squared;
  return square;
}

// Let s = v.w, V = skew(v) and W = skew(w). With V W = w v' - s I and W V W = -s W, Barfoot's
// Q(v, w) simplifies to
//   Q = (1/2 + c theta^2) V - s (b + 2c) W + b (v w' + w v') - 2 d s w w' + 2 s (d theta^2 - b) I
//   b = (theta - sin)/theta^3, c = (1 - theta^2/2 - cos)/theta^4,
//   d = (2 theta - 3 sin + theta cos)/(2 theta^5)
Eigen::Matrix3d ErrorJacobian::coupling() const {
  if (identity_) return Eigen::Matrix3d::Zero();
  const Eigen::Vector3d& v = error_.linear;
  const Eigen::Vector3d& w = error_.angular;
  const double square = error_.angle_squared;
  const double fourth = square * square;
  const double b = (angle_ - sine_) / (square * angle_);
  const double c = (1.0 - 0.5 * square - cosine_) / fourth;
  const double d = (2.0 * angle_ - 3.0 * sine_ + angle_ * cosine_) / (2.0 * fourth * angle_);
  const double s = v.dot(w);

  const Eigen::Vector3d turned = (0.5 + c * square) * v - (s * (b + 2.0 * c)) * w;
  const Eigen::Vector3d left = b * v - (2.0 * d * s) * w;  // Enters Q as left w' + (b w) v'.
  Eigen::Matrix3d q = left * w.transpose() + (b * w) * v.transpose();
  q += skew(turned);
  q.diagonal().array() += 2.0 * s * (d * square - b);

  // Q A = Q - 1/2 Q W + beta (Q w w' - theta^2 Q)
  const Eigen::Vector3d qw = q * w;
  Eigen::Matrix3d qa = (1.0 - beta_ * square) * q;
  qa += (beta_ * qw) * w.transpose();
  for (int row = 0; row < 3; ++row) {
    // (Q W) row by row: q' W = (q x w)'.
    const Eigen::Vector3d q_row = q.row(row).transpose();
    qa.row(row) -= 0.5 * q_row.cross(w).transpose();
  }
  return qa;
}

}  // namespace retarget
