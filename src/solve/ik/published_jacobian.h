#pragma once

#include "base/math/se3.h"

namespace retarget {

/// Inverse of the left Jacobian of SE(3) at the twist x, as the published two-pass method computes
/// it: log(exp(d) exp(x)) is x + published_jacobian_inverse(x) d to first order in d (Barfoot,
/// "State Estimation for Robotics", section 7.1.5; Sola et al., eq. 179b), except for the errors
/// below.
///
/// Only for the published method, whose trajectories depend on the last digits of this result. Its
/// switch and closed forms are kept unchanged. Below an angle of 1e-5 rad, the result is the
/// identity, which neglects the coupling -skew(v)/2 of position and rotation (it moves joints by up
/// to 3 mrad). Above, the forms lose 3e-16 / angle^2 to cancellation in A and 2e-16 / angle^2 |v|
/// in the coupling: 8e-7 at 1e-5 rad, 5e-9 at 1e-4, 2e-11 at 1e-3. They are finite at every angle
/// below 2 pi. All other code uses left_jacobian_inverse_so3, which is accurate at every angle.
[[nodiscard]] Matrix6d published_jacobian_inverse(const Vector6d& x);

}  // namespace retarget
