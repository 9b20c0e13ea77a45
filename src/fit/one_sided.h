#pragma once

namespace retarget {

/// A row of a least-squares problem: half the cost's gradient is weight * residual along the row's
/// Jacobian, half its curvature is weight.
struct OneSidedRow {
  double weight = 0.0;
  double residual = 0.0;
  double cost = 0.0;
};

/// The square of how far a value is below 0, but with a curvature that grows evenly from 0 to its
/// whole over [-band, band].
///
/// Where the curvature jumps, the last bit of a value decides how stiff the next step thinks it is:
/// starts are lifted until their lowest point is at 0 exactly, and single runs of rounding then came
/// out millimetres apart. Below -band the gradient is that of the square.
/// @return all 0 for values of `band` and above.
inline OneSidedRow one_sided(double value, double band) {
  const double inside = band - value;
  if (inside <= 0.0) return {};
  if (inside >= 2.0 * band) return {1.0, value, value * value + band * band / 3.0};
  return {inside / (2.0 * band), -0.5 * inside, inside * inside * inside / (6.0 * band)};
}

}  // namespace retarget
