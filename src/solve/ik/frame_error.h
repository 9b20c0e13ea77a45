#pragma once

#include <Eigen/Core>

#include "retarget/pose.h"

namespace retarget {

/// Small-angle thresholds of the published method; see published_jacobian_inverse().
inline constexpr double kSmallAngleSquared = 1e-10;
inline constexpr double kNoRotation = 1e-10;
/// Angle (0.02 rad, squared) above which the sine and cosine may come from the quaternion. Below
/// it, the rounding error of the closed forms depends on the last bit of the sine, so that both
/// engines must compute it in the same way.
inline constexpr double kPlainAngleSquared = 4e-4;

/// The error of a frame task in world axes, from a single logarithm.
///
/// With the error twist e = log(T_wb^-1 T_wt) = [e_v; w] of the published method and A = J_l^-1(w)
/// on SO(3) (which is also the V^-1 of the logarithm), the inverse left Jacobian of SE(3) is
///   [[A, -A Q A], [0, A]].
/// A rotation of e from body to world axes changes neither norms nor A'A, so all quantities are in
/// world axes (docs/ik.md).
struct FrameError {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< The linear part e_v, metres.
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< The rotation vector w, radians.
  double angle_squared = 0.0;
  double half_sine = 0.0;  ///< Sine of half the angle, from the quaternion.
  double half_cosine = 1.0;

  [[nodiscard]] double squared_norm() const { return linear.squaredNorm() + angle_squared; }
};

/// The error of a body relative to its target.
[[nodiscard]] FrameError frame_error(const Pose& world_from_body, const Pose& world_from_target);

/// Derivative of the error with respect to the body's velocity: the matrices A and Q A of
/// FrameError.
///
/// Uses the closed forms of the reference engine (published_jacobian_inverse()), also at small
/// angles, where digits cancel. The same expressions of the same values lose the same digits, so
/// that both engines agree.
class ErrorJacobian {
 public:
  /// @param error  must outlive this object.
  explicit ErrorJacobian(const FrameError& error);

  /// A'v.
  [[nodiscard]] Eigen::Vector3d transposed_times(const Eigen::Vector3d& v) const;
  /// A'A = I + gamma (w w' - |w|^2 I).
  [[nodiscard]] Eigen::Matrix3d square() const;
  /// Q A.
  [[nodiscard]] Eigen::Matrix3d coupling() const;

 private:
  const FrameError& error_;
  bool identity_;  // Whether the angle is so small that A is I and Q is 0.
  double angle_ = 0.0;
  double sine_ = 0.0, cosine_ = 1.0;
  double beta_ = 0.0;  // A = I - W/2 + beta W^2.
};

}  // namespace retarget
