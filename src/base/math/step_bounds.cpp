#include "base/math/step_bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace retarget {

double bound_steps(std::span<double> values, double lower, double upper, double step) {
  bool inside = true;
  for (std::size_t i = 0; i < values.size(); ++i) {
    inside = inside && values[i] >= lower && values[i] <= upper &&
             (i == 0 || std::abs(values[i] - values[i - 1]) <= step);
  }
  if (inside) return 0.0;
  std::vector<double> low;
  low.reserve(values.size());
  for (const double value : values) low.push_back(std::clamp(value, lower, upper));
  std::vector<double> high = low;
  for (std::size_t i = 1; i < values.size(); ++i) {
    low[i] = std::min(low[i], low[i - 1] + step);
    high[i] = std::max(high[i], high[i - 1] - step);
  }
  for (std::size_t i = values.size() - 1; i > 0; --i) {
    low[i - 1] = std::min(low[i - 1], low[i] + step);
    high[i - 1] = std::max(high[i - 1], high[i] - step);
  }
  double max = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    // Values that need no change keep all their digits.
    const double bounded = low[i] == high[i] ? low[i] : 0.5 * (low[i] + high[i]);
    max = std::max(max, std::abs(bounded - values[i]));
    values[i] = bounded;
  }
  return max;
}

StepBounds bounds_for_rounding(const StepBounds& bounds, int decimals, double per_unit) {
  constexpr double kRounding = 1e-12;
  double digit = 1.0;
  for (int i = 0; i < decimals; ++i) digit *= 0.1;
  const double grid = digit / per_unit, per_bound = std::round(1.0 / digit) * per_unit;
  StepBounds inside{std::ceil(bounds.lower * per_bound) / per_bound,
                    std::floor(bounds.upper * per_bound) / per_bound,
                    std::max(bounds.step - grid - kRounding, 0.5 * bounds.step)};
  if (inside.lower > inside.upper)
    inside.lower = inside.upper = 0.5 * (bounds.lower + bounds.upper);
  return inside;
}

StepBounds bounds_for_printing(StepBounds bounds, int decimals, bool slides,
                               std::span<const PrintedUnits> units) {
  constexpr double kCoarsest = 2e-3;
  for (const PrintedUnits& unit : units) {
    const double per_unit = slides ? unit.per_metre : unit.per_radian;
    int digits = 0;
    for (double grid = 1.0 / per_unit; digits < decimals || grid > kCoarsest; ++digits) grid *= 0.1;
    bounds = bounds_for_rounding(bounds, digits, per_unit);
  }
  return bounds;
}

}  // namespace retarget
