#pragma once

namespace retarget {

/// A one-sided residual in a least-squares problem: half the gradient of its cost is weight *
/// residual along its Jacobian; half its curvature is weight.
struct OneSidedRow {
  double weight = 0.0;
  double residual = 0.0;
  double cost = 0.0;
};

/// The squared violation of value >= 0, smoothed: its curvature grows linearly from 0 to its full
/// value over [-band, band].
///
/// With a jump in the curvature, the last bit of a value would decide how stiff the next step is.
/// Start poses are lifted until their lowest point is exactly at 0, so rounding alone led to
/// results that differed by millimetres. Below -band, the gradient equals the gradient of the
/// square.
/// @return all zeros for values >= `band`.
inline OneSidedRow one_sided(double value, double band) {
  const double inside = band - value;
  if (inside <= 0.0) return {};
  if (inside >= 2.0 * band) return {1.0, value, value * value + band * band / 3.0};
  return {inside / (2.0 * band), -0.5 * inside, inside * inside * inside / (6.0 * band)};
}

}  // namespace retarget
