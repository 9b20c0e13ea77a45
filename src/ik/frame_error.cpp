#include "ik/frame_error.h"

#include <cmath>

#include "retarget/math/se3.h"

namespace retarget {
namespace {

// the published method's switches, see left_jacobian_inverse_se3
constexpr double kSmallAngleSquared = 1e-10;
constexpr double kNoRotation = 1e-10;

}  // namespace

FrameError frame_error(const Pose& world_from_body, const Pose& world_from_target) {
  FrameError error;
  error.offset = world_from_target.translation - world_from_body.translation;
  // the turn from the body to the target, in world axes; of q and -q the one with w >= 0
  const Eigen::Quaterniond turn = world_from_target.rotation * world_from_body.rotation.conjugate();
  const double w = std::abs(turn.w());
  const double n = turn.vec().norm();
  double angle = 0.0;
  if (n >= kNoRotation) {
    angle = 2.0 * std::atan2(n, w);
    error.angular = (std::copysign(angle, turn.w()) / n) * turn.vec();
    error.angle_squared = angle * angle;
  }
  const Eigen::Vector3d cross = error.angular.cross(error.offset);
  error.small = error.angle_squared < kSmallAngleSquared;
  if (error.small) {
    error.linear = error.offset - 0.5 * cross + error.angular.cross(cross) / 12.0;
    return error;
  }
  // half angles come with the quaternion: no trigonometry beyond the one arc tangent
  error.beta = (1.0 - 0.5 * angle * w / n) / error.angle_squared;
  error.sine = 2.0 * n * w;
  error.one_minus_cosine = 2.0 * n * n;
  error.linear = error.offset - 0.5 * cross + error.beta * error.angular.cross(cross);
  return error;
}

// With s = v.w, V = skew(v), W = skew(w) Barfoot's Q(v, w) is, by V W = w v' - s I and W V W = -s W,
//   Q = (1 - cos)/theta^2 V - s (b + 2c) W + b (v w' + w v') - 2 d s w w' + 2 s (d theta^2 - b) I
//   b = (theta - sin)/theta^3, c = (1 - theta^2/2 - cos)/theta^4,
//   d = (2 theta - 3 sin + theta cos)/(2 theta^5)
Eigen::Matrix3d coupling(const FrameError& error) {
  const Eigen::Vector3d& v = error.linear;
  const Eigen::Vector3d& w = error.angular;
  const double square = error.angle_squared;
  const double angle = std::sqrt(square);
  const double fourth = square * square;
  const double b = (angle - error.sine) / (square * angle);
  const double c = (error.one_minus_cosine - 0.5 * square) / fourth;
  const double d =
      (3.0 * (angle - error.sine) - angle * error.one_minus_cosine) / (2.0 * fourth * angle);
  const double s = v.dot(w);

  const Eigen::Vector3d turned = (error.one_minus_cosine / square) * v - (s * (b + 2.0 * c)) * w;
  const Eigen::Vector3d left = b * v - (2.0 * d * s) * w;  // left w' + (b w) v'
  Eigen::Matrix3d q = left * w.transpose() + (b * w) * v.transpose();
  q += skew(turned);
  q.diagonal().array() += 2.0 * s * (d * square - b);

  // Q A = Q - 1/2 Q W + beta (Q w w' - theta^2 Q)
  const Eigen::Vector3d qw = q * w;
  Eigen::Matrix3d qa = (1.0 - error.beta * square) * q;
  qa += (error.beta * qw) * w.transpose();
  for (int row = 0; row < 3; ++row) {
    // (Q W) row by row: q' W = (q x w)'
    const Eigen::Vector3d q_row = q.row(row).transpose();
    qa.row(row) -= 0.5 * q_row.cross(w).transpose();
  }
  return qa;
}

}  // namespace retarget
