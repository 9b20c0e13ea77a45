#pragma once

#include <span>
#include <vector>

namespace retarget {

/// @pre there are values
[[nodiscard]] double mean(const std::vector<double>& values);

/// The p-th percentile of the values, 0 <= p <= 100, with linear interpolation between the two
/// nearest ranks p / 100 * (n - 1), as NumPy's percentile does by default.
/// @pre there are values, none of them NaN
[[nodiscard]] double percentile(std::vector<double> values, double p);

/// The value in the middle; of an even number of values the mean of the two.
/// @pre there are values, none of them NaN
[[nodiscard]] double median(std::vector<double> values);
/// The same without a copy: the values are in another order afterwards.
[[nodiscard]] double median_in_place(std::span<double> values);

}  // namespace retarget
