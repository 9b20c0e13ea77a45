#pragma once

#include <span>

namespace retarget {

/// Brings a sequence of numbers inside `lower` and `upper` and makes it change by no more than
/// `step` from one to the next. Numbers that do already stay as they are.
///
/// With the lower envelope a_t = min_s (x_s + step |t - s|) and the upper one
/// b_t = max_s (x_s - step |t - s|) of the clamped numbers the result is (a + b) / 2: both
/// envelopes and so their mean keep the bounds, and no sequence that changes as little is nearer to
/// the clamped one in its largest deviation. Nothing lags behind, as it would with a clamp from
/// frame to frame.
///
/// @return the largest deviation from the numbers given.
double bound_steps(std::span<double> values, double lower, double upper, double step);

/// What bound_steps is asked for.
struct StepBounds {
  double lower = 0.0, upper = 0.0, step = 0.0;
};

/// Bounds inside these that hold as well for numbers that are then rounded to so many decimals. A range
/// too narrow for any such number becomes its middle; a step shorter than two of their last digits becomes its half.
[[nodiscard]] StepBounds bounds_for_rounding(const StepBounds& bounds, int decimals);

}  // namespace retarget
