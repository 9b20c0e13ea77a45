#pragma once

#include <Eigen/Core>

#include "retarget/math/pose.h"

namespace retarget {

/// Everything that one logarithm tells about a frame task, in world axes.
///
/// With the error twist e = log(T_wb^-1 T_wt) = [e_v; w] of the published method and
/// A = J_l^-1(w) on SO(3) (which is also the V^-1 of the logarithm), the inverse left Jacobian of
/// SE(3) is [[A, -A Q A], [0, A]]. Turning e from the body's axes into the world's changes neither
/// norms nor A'A, so all of it is kept in world axes:
///
///     A'A = I + gamma (w w' - |w|^2 I),   A'w = w,   e_v = A t,   t = p_target - p_body
///
/// (docs/ik.md derives them).
struct FrameError {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< e_v, metres.
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< w, radians.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();   ///< t, metres.
  double angle_squared = 0.0;
  double beta = 0.0;  ///< A = I - W/2 + beta W^2; zero below the small-angle switch.
  double sine = 0.0;  ///< Of the angle.
  double one_minus_cosine = 0.0;
  bool small = true;  ///< Below the switch: the Jacobian is the identity.

  [[nodiscard]] double squared_norm() const { return linear.squaredNorm() + angle_squared; }
};

[[nodiscard]] FrameError frame_error(const Pose& world_from_body, const Pose& world_from_target);

/// Q A of the inverse left Jacobian, for an error above the small-angle switch; world axes.
[[nodiscard]] Eigen::Matrix3d coupling(const FrameError& error);

}  // namespace retarget
