#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// The unit quaternion that rotates by |w| rad about w.
///
/// Accurate at every angle: below 1e-4 rad, a series replaces sin(x)/x, with a truncation error
/// below rounding.
[[nodiscard]] Eigen::Quaterniond exp_so3(const Eigen::Vector3d& w);

/// The rotation vector w with exp_so3(w) = +-q and |w| <= pi; the inverse of exp_so3 below pi.
///
/// q and -q give identical bits. Accurate at every angle: uses 2 atan2 of vector and scalar part,
/// and below 1e-4 rad the series of atan. Half a turn (scalar part 0) has two solutions; the result
/// is the one whose first non-zero component is positive. q must be non-zero but need not be
/// normalised.
[[nodiscard]] Eigen::Vector3d log_so3(const Eigen::Quaterniond& q);

/// The cross-product matrix: skew(a) * b = a x b.
[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& a);

/// Inverse of the left Jacobian of SO(3) at the rotation vector w: log(exp(d) exp(w)) is
/// w + left_jacobian_inverse_so3(w) d to first order in d. Valid for |w| < 2 pi; the error is below
/// 5e-15 of its norm up to pi.
[[nodiscard]] Eigen::Matrix3d left_jacobian_inverse_so3(const Eigen::Vector3d& w);
/// left_jacobian_inverse_so3(w) * v.
[[nodiscard]] Eigen::Vector3d apply_left_jacobian_inverse_so3(const Eigen::Vector3d& w,
                                                              const Eigen::Vector3d& v);

/// Right Jacobian of SO(3) at w: if w changes at `rate`, exp(w) rotates with the body-frame angular
/// velocity right_jacobian_so3(w) * rate. The error is below 5e-15 of its norm up to pi.
[[nodiscard]] Eigen::Matrix3d right_jacobian_so3(const Eigen::Vector3d& w);
/// Time derivative of the right Jacobian at w, for dw/dt = `rate`, times `rate`.
[[nodiscard]] Eigen::Vector3d right_jacobian_rate_so3(const Eigen::Vector3d& w,
                                                      const Eigen::Vector3d& rate);

/// The minimal rotation from direction a to direction b, both of any non-zero length. For opposite
/// directions, the axis is one of the perpendicular axes. The error is below 1e-13, also near
/// opposite directions. Wraps Eigen's FromTwoVectors in most cases: its singular value
/// decomposition takes five seconds to compile in every file that calls it.
[[nodiscard]] Eigen::Quaterniond rotation_between(const Eigen::Vector3d& a,
                                                  const Eigen::Vector3d& b);

/// The rotation about the vertical of a rotation (swing-twist decomposition); identity if the
/// rotation turns the vertical upside down. A turn of the world about the vertical turns it alike.
[[nodiscard]] Eigen::Quaterniond turn_about_vertical(const Eigen::Quaterniond& rotation);

/// Negates q if -q, which is the same rotation, is nearer to the reference. Both must use the same
/// component order: Eigen's or w first.
inline void align_sign(const Eigen::Ref<const Eigen::Vector4d>& reference,
                       Eigen::Ref<Eigen::Vector4d> q) {
  if (q.dot(reference) < 0.0) q = -q;
}

/// Angle between two directions of any length, rad, in [0, pi]; 0 if one is the zero vector.
[[nodiscard]] double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace retarget
