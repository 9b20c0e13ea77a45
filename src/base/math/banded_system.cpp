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

PentadiagonalFit::PentadiagonalFit(std::size_t count)
    : diagonal_(count), next_(count), second_(count), right_(count) {}

void PentadiagonalFit::add_value(std::size_t i, double weight, double target) {
  diagonal_[i] += weight;
  right_[i] += weight * target;
}

void PentadiagonalFit::add_difference(std::size_t i, double weight, double target) {
  diagonal_[i] += weight;
  diagonal_[i + 1] += weight;
  next_[i] -= weight;
  right_[i] -= weight * target;
  right_[i + 1] += weight * target;
}

void PentadiagonalFit::add_second_difference(std::size_t i, double weight, double target) {
  diagonal_[i] += weight;
  diagonal_[i + 1] += 4.0 * weight;
  diagonal_[i + 2] += weight;
  next_[i] -= 2.0 * weight;
  next_[i + 1] -= 2.0 * weight;
  second_[i] += weight;
  right_[i] += weight * target;
  right_[i + 1] -= 2.0 * weight * target;
  right_[i + 2] += weight * target;
}

std::vector<double> PentadiagonalFit::solve() const {
  const std::size_t count = diagonal_.size();
  // L D L^T with a unit lower triangle of two diagonals
  std::vector<double> pivot(count), first(count), second(count), x(right_);
  for (std::size_t i = 0; i < count; ++i) {
    pivot[i] = diagonal_[i];
    double below = next_[i];
    if (i >= 1) {
      pivot[i] -= first[i - 1] * first[i - 1] * pivot[i - 1];
      below -= first[i - 1] * second[i - 1] * pivot[i - 1];
      x[i] -= first[i - 1] * x[i - 1];
    }
    if (i >= 2) {
      pivot[i] -= second[i - 2] * second[i - 2] * pivot[i - 2];
      x[i] -= second[i - 2] * x[i - 2];
    }
    first[i] = below / pivot[i];
    second[i] = second_[i] / pivot[i];
  }
  for (std::size_t i = count; i-- > 0;) {
    x[i] /= pivot[i];
    if (i + 1 < count) x[i] -= first[i] * x[i + 1];
    if (i + 2 < count) x[i] -= second[i] * x[i + 2];
  }
  return x;
}

std::vector<double> smoothed(const std::vector<double>& y, double strength) {
  PentadiagonalFit fit(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) fit.add_value(i, 1.0, y[i]);
  for (std::size_t i = 0; i + 2 < y.size(); ++i) fit.add_second_difference(i, strength, 0.0);
  return fit.solve();
}

}  // namespace retarget
