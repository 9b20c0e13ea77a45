#include "base/math/banded_system.h"

#include <algorithm>
#include <cmath>

namespace retarget {

void BandedSystem::begin(std::size_t size, std::size_t width) {
  width_ = width;
  entries_.assign(size * width, 0.0);
  right_.assign(size, 0.0);
}

std::optional<double> BandedSystem::solve(std::size_t first, std::size_t last) {
  // First column of a row in the band.
  const auto start = [&](std::size_t i) {
    return std::max(first, i < width_ ? 0 : i - width_ + 1);
  };
  std::vector<double>& y = right_;
  for (std::size_t i = first; i < last; ++i) {
    double* const a = row(i);
    const std::size_t begin = start(i);
    for (std::size_t j = begin; j < i; ++j) {
      const double* const c = row(j);
      double sum = a[j];
      for (std::size_t k = begin; k < j; ++k) sum -= a[k] * c[k];
      a[j] = sum / c[j];
    }
    double pivot = a[i];
    for (std::size_t k = begin; k < i; ++k) {
      pivot -= a[k] * a[k];
      y[i] -= a[k] * y[k];
    }
    if (!std::isfinite(pivot)) return NAN;
    if (!(pivot > 0.0)) return std::nullopt;
    a[i] = std::sqrt(pivot);
    y[i] /= a[i];
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
