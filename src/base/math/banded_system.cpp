#include "base/math/banded_system.h"

#include <algorithm>
#include <cmath>

#include "base/math/simd.h"

namespace retarget {
namespace {

// Subtracts the product of a column with itself from the rows below, and its part of the right side.
// Each entry is the target of the same subtractions in the same order as in a loop over rows, but
// here they run along rows and vectorise.
RETARGET_INLINE void subtract_column_plain(const double* __restrict column, std::size_t count,
                                           std::size_t row_step, double* __restrict first_row,
                                           double solved, double* __restrict right) {
  double* row = first_row;
  for (std::size_t i = 0; i < count; ++i) {
    const double factor = column[i];
    for (std::size_t j = 0; j <= i; ++j) row[j] -= factor * column[j];
    right[i] -= factor * solved;
    row += row_step;
  }
}
RETARGET_AVX2(subtract_column)

}  // namespace

void BandedSystem::begin(std::size_t size, std::size_t width) {
  width_ = width;
  entries_.assign(size * width, 0.0);
  right_.assign(size, 0.0);
  column_.resize(width);
}

std::optional<double> BandedSystem::solve(std::size_t first, std::size_t last) {
  // First column of a row in the band.
  const auto start = [&](std::size_t i) {
    return std::max(first, i < width_ ? 0 : i - width_ + 1);
  };
  const bool wide = has_avx2();
  std::vector<double>& y = right_;
  for (std::size_t k = first; k < last; ++k) {
    double& diagonal = row(k)[k];
    if (!std::isfinite(diagonal)) return NAN;
    if (!(diagonal > 0.0)) return std::nullopt;
    diagonal = std::sqrt(diagonal);
    y[k] /= diagonal;
    const std::size_t count = std::min(k + width_, last) - (k + 1);
    for (std::size_t i = 0; i < count; ++i) {
      column_[i] = row(k + 1 + i)[k] /= diagonal;
    }
    if (count > 0) {
      subtract_column(wide, column_.data(), count, width_ - 1, row(k + 1) + k + 1, y[k],
                      y.data() + k + 1);
    }
  }
  double largest = 0.0;
  for (std::size_t i = last; i-- > first;) {
    const double* const a = row(i);
    y[i] /= a[i];
    for (std::size_t k = start(i); k < i; ++k) y[k] -= a[k] * y[i];
    if (!std::isfinite(y[i])) return NAN;
    largest = std::max(largest, std::abs(y[i]));
  }
  std::fill(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(first), 0.0);
  std::fill(y.begin() + static_cast<std::ptrdiff_t>(last), y.end(), 0.0);
  return largest;
}

}  // namespace retarget
