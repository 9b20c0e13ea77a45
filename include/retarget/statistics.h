#pragma once

#include <span>
#include <vector>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Arithmetic mean; NaN if there are no values.
[[nodiscard]] double mean(const std::vector<double>& values);

/// The p-th percentile of the values, 0 <= p <= 100, with linear interpolation between the two
/// nearest ranks p / 100 * (n - 1), as NumPy's default. NaN if there are no values or if one of
/// them is NaN.
[[nodiscard]] double percentile(std::vector<double> values, double p);

/// The middle value; for an even number of values, the mean of the two middle values. NaN as for
/// percentile().
[[nodiscard]] double median(std::vector<double> values);
/// Like median(), but without a copy: reorders the values.
[[nodiscard]] double median_in_place(std::span<double> values);

}  // namespace retarget
