#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace retarget {

/// The unit quaternion that turns by |w| rad about w.
///
/// Full accuracy at every angle: below 1e-4 rad sin(x)/x is replaced by its series, whose first
/// term left out is there smaller than rounding.
[[nodiscard]] Eigen::Quaterniond exp_so3(const Eigen::Vector3d& w);

/// The rotation vector w with exp_so3(w) = +-q and |w| <= pi; the inverse of exp_so3 below pi.
///
/// q and -q give the same vector, bit for bit. Full accuracy at every angle: 2 atan2 of the two
/// parts, and below 1e-4 rad the series of atan. Half a turn (w part zero) has two vectors; the
/// one whose first non-zero component is positive is taken. q need not be of unit length, only
/// not zero.
[[nodiscard]] Eigen::Vector3d log_so3(const Eigen::Quaterniond& q);

/// Left Jacobian inverse of SO(3) at w applied to a vector: log(exp(e v) exp(w)) is
/// w + e * apply_left_jacobian_inverse_so3(w, v) to first order in e. For |w| < 2 pi.
[[nodiscard]] Eigen::Vector3d apply_left_jacobian_inverse_so3(const Eigen::Vector3d& w,
                                                              const Eigen::Vector3d& v);

/// The minimal rotation that takes direction a to direction b, both of any length but zero;
/// of opposite directions about one of the axes across them. Eigen's FromTwoVectors, whose singular
/// value decomposition takes five seconds in every file that calls it.
[[nodiscard]] Eigen::Quaterniond rotation_between(const Eigen::Vector3d& a,
                                                  const Eigen::Vector3d& b);

/// Of q and -q, which are the same rotation, the one that is nearer to a reference. Both as Eigen
/// stores them or both with w first.
inline void align_sign(const Eigen::Ref<const Eigen::Vector4d>& reference,
                       Eigen::Ref<Eigen::Vector4d> q) {
  if (q.dot(reference) < 0.0) q = -q;
}

/// Angle between two directions of any length in [0, pi], rad; 0 where one has none.
[[nodiscard]] double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace retarget
