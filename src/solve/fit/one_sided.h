#pragma once

namespace retarget {

/// The contribution of an inequality to a least-squares problem. With the Jacobian J of its value,
/// half the gradient of the cost is J' * weight * residual, and half the Hessian is J' * weight *
/// J.
struct OneSidedRow {
  double weight = 0.0;
  double residual = 0.0;
  double cost = 0.0;
};

/// The smoothed squared violation of value >= 0. Its curvature grows linearly from 0 at `band` to
/// its full value at -band. Below -band, its gradient equals that of the square.
///
/// With a jump in the curvature, the last bit of a value would change the stiffness of the next
/// step. Start poses are lifted until their lowest point is exactly at 0, so that rounding errors
/// alone changed results by millimetres.
/// @return all zeros for values >= `band`.
inline OneSidedRow one_sided(double value, double band) {
  const double inside = band - value;
  if (inside <= 0.0) return {};
  if (inside >= 2.0 * band) return {1.0, value, value * value + band * band / 3.0};
  return {inside / (2.0 * band), -0.5 * inside, inside * inside * inside / (6.0 * band)};
}

}  // namespace retarget
