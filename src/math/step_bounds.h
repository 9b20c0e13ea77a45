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

}  // namespace retarget
