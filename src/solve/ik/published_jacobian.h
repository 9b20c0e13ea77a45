#pragma once

#include "base/math/se3.h"

namespace retarget {

/// Inverse of the left Jacobian of SE(3) at the twist x, as the published two-pass method computes
/// it: log(exp(d) exp(x)) is x + published_jacobian_inverse(x) d to first order in d (Barfoot,
/// "State Estimation for Robotics", section 7.1.5; Sola et al., eq. 179b), except for the errors
/// below.
///
/// Use it only for the published method, whose trajectories depend on the last digits of the result,
/// and for diagnoses of limits. The small-angle threshold and the closed forms are therefore those
/// of the method. Below 1e-5 rad, the result is the identity, which neglects the coupling -skew(v)/2 of position and
/// rotation (an effect of up to 3 mrad on joints). Above, cancellation causes errors of 3e-16 /
/// angle^2 in A and 2e-16 / angle^2 |v| in the coupling: 8e-7 at 1e-5 rad, 5e-9 at 1e-4, 2e-11 at
/// 1e-3. The forms are finite for all angles below 2 pi. All other code uses
/// left_jacobian_inverse_so3(), which is accurate for all angles.
[[nodiscard]] Matrix6d published_jacobian_inverse(const Vector6d& x);

}  // namespace retarget
