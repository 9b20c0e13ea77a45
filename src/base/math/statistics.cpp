#include "retarget/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace retarget {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// NaN has no order, and sorting algorithms would then read out of bounds.
bool can_be_ordered(std::span<const double> values) {
  return !values.empty() &&
         std::ranges::none_of(values, [](double value) { return std::isnan(value); });
}

}  // namespace

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double percentile(std::vector<double> values, double p) {
  if (!can_be_ordered(values)) return kNoNumber;
  const double rank = p / 100.0 * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(below);
  std::ranges::nth_element(values, at);
  const double low = *at;
  if (below + 1 >= values.size()) return low;
  const double high = *std::ranges::min_element(at + 1, values.end());
  const double share = rank - static_cast<double>(below);
  if (!std::isfinite(high - low)) return share < 0.5 ? low : high;
  // Interpolates from the nearer value, so that a share of 1 would give the upper value exactly.
  return share < 0.5 ? low + (high - low) * share : high - (high - low) * (1.0 - share);
}

double median(std::vector<double> values) {
  return median_in_place(values);
}

double median_in_place(std::span<double> values) {
  if (!can_be_ordered(values)) return kNoNumber;
  const std::size_t half = values.size() / 2;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(half);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::ranges::max_element(values.begin(), middle));
}

}  // namespace retarget
