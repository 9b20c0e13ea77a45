#pragma once

#include <span>

namespace retarget {

/// Clamps a sequence to [lower, upper] and limits its change between neighbours to `step`. Values
/// that already satisfy the bounds do not change.
///
/// The result is (a + b) / 2 with the lower envelope a_t = min_s (x_s + step |t - s|) and the upper
/// envelope b_t = max_s (x_s - step |t - s|) of the clamped values. Both envelopes satisfy the
/// bounds, hence so does their mean. No other sequence within the bounds has a smaller largest
/// deviation from the clamped values. Unlike a clamp from frame to frame, this causes no lag.
///
/// @return the largest deviation from the given values.
double bound_steps(std::span<double> values, double lower, double upper, double step);

/// Arguments of bound_steps.
struct StepBounds {
  double lower = 0.0, upper = 0.0, step = 0.0;
};

/// Tightens bounds so that values still satisfy the original bounds after rounding to `decimals`
/// digits. A range that contains no such value becomes its midpoint. A step shorter than two units
/// of the last digit is halved.
/// @param per_unit  rounding units per unit of the bounds, e.g. 57.3 for degrees and radians.
[[nodiscard]] StepBounds bounds_for_rounding(const StepBounds& bounds, int decimals,
                                             double per_unit = 1.0);

/// Units of printed joint positions.
struct PrintedUnits {
  static constexpr double kDegrees = 57.29577951308232087680;  ///< Degrees per radian.
  static constexpr double kCentimetres = 100.0;                ///< Centimetres per metre.

  double per_radian = 1.0;
  double per_metre = 1.0;
};

/// Applies bounds_for_rounding for each of the units. If `decimals` is too coarse for a unit,
/// enough digits are used to resolve 2 mm or 2 mrad.
/// @param slides  whether the values are lengths rather than angles.
[[nodiscard]] StepBounds bounds_for_printing(StepBounds bounds, int decimals, bool slides,
                                             std::span<const PrintedUnits> units);

}  // namespace retarget
