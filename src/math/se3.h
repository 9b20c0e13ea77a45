#pragma once

#include <Eigen/Core>

#include "retarget/pose.h"

namespace retarget {

/// Six-vectors of a rigid motion: three linear components first, then three angular ones.
using Vector6d = Eigen::Matrix<double, 6, 1>;
/// Rows and columns in the order of Vector6d.
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// The matrix of the cross product: skew(a) * b = a x b.
[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& a);

/// The twist [v; w] with exp([v; w]) = a_from_b, |w| <= pi (Sola et al., "A micro Lie theory for
/// state estimation in robotics", eqs. 172-174). In frame a (and in frame b: they differ only by
/// the motion itself).
[[nodiscard]] Vector6d log_se3(const Pose& a_from_b);

/// Inverse of the left Jacobian of SO(3) at the rotation vector w: log(exp(d) exp(w)) is
/// w + left_jacobian_inverse_so3(w) d to first order in d.
[[nodiscard]] Eigen::Matrix3d left_jacobian_inverse_so3(const Eigen::Vector3d& w);

/// Inverse of the left Jacobian of SE(3) at the twist x: log(exp(d) exp(x)) is
/// x + left_jacobian_inverse_se3(x) d to first order in d (Barfoot, "State Estimation for
/// Robotics", section 7.1.5; Sola et al., eq. 179b).
///
/// The closed forms are those of the published two-pass method, to the letter: below an angle of
/// 1e-5 rad the result is the identity, which leaves out the coupling -skew(v)/2 of position and
/// rotation. Trajectories depend on that switch, so it must stay (it moves joints by up to
/// 3 mrad). The forms lose digits to cancellation near the switch: 8e-7 at 1e-5 rad, 5e-9 at
/// 1e-4, 2e-11 at 1e-3.
[[nodiscard]] Matrix6d left_jacobian_inverse_se3(const Vector6d& x);

}  // namespace retarget
