#include "base/math/banded_system.h"

#include <algorithm>
#include <array>
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

void PentadiagonalMatrix::add_difference(std::size_t i, double weight) {
  rows_[i].diagonal += weight;
  rows_[i + 1].diagonal += weight;
  rows_[i].next -= weight;
}

void PentadiagonalMatrix::add_second_difference(std::size_t i, double weight) {
  rows_[i].diagonal += weight;
  rows_[i + 1].diagonal += 4.0 * weight;
  rows_[i + 2].diagonal += weight;
  rows_[i].next -= 2.0 * weight;
  rows_[i + 1].next -= 2.0 * weight;
  rows_[i].second += weight;
}

double PentadiagonalMatrix::absolute_row_sum(std::size_t i) const {
  double sum = std::abs(rows_[i].diagonal) + std::abs(rows_[i].next) + std::abs(rows_[i].second);
  if (i >= 1) sum += std::abs(rows_[i - 1].next);
  if (i >= 2) sum += std::abs(rows_[i - 2].second);
  return sum;
}

void PentadiagonalMatrix::factorise() {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Row& row = rows_[i];
    if (i >= 1) {
      const Row& above = rows_[i - 1];
      row.diagonal -= above.next * above.next * above.diagonal;
      row.next -= above.next * above.second * above.diagonal;
    }
    if (i >= 2) row.diagonal -= rows_[i - 2].second * rows_[i - 2].second * rows_[i - 2].diagonal;
    row.next /= row.diagonal;
    row.second /= row.diagonal;
  }
}

void PentadiagonalMatrix::solve(const double* right, double* x, std::size_t stride,
                                std::span<const int> columns) const {
  const std::size_t count = rows_.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (const int column : columns) {
      const std::size_t here = i * stride + static_cast<std::size_t>(column);
      double value = right[here];
      if (i >= 1) value -= rows_[i - 1].next * x[here - stride];
      if (i >= 2) value -= rows_[i - 2].second * x[here - 2 * stride];
      x[here] = value;
    }
  }
  for (std::size_t i = count; i-- > 0;) {
    for (const int column : columns) {
      const std::size_t here = i * stride + static_cast<std::size_t>(column);
      double value = x[here] / rows_[i].diagonal;
      if (i + 1 < count) value -= rows_[i].next * x[here + stride];
      if (i + 2 < count) value -= rows_[i].second * x[here + 2 * stride];
      x[here] = value;
    }
  }
}

PentadiagonalFit::PentadiagonalFit(std::size_t count) : right_(count) {
  matrix_.begin(count);
}

void PentadiagonalFit::add_value(std::size_t i, double weight, double target) {
  matrix_.add_value(i, weight);
  right_[i] += weight * target;
}

void PentadiagonalFit::add_difference(std::size_t i, double weight, double target) {
  matrix_.add_difference(i, weight);
  right_[i] -= weight * target;
  right_[i + 1] += weight * target;
}

void PentadiagonalFit::add_second_difference(std::size_t i, double weight, double target) {
  matrix_.add_second_difference(i, weight);
  right_[i] += weight * target;
  right_[i + 1] -= 2.0 * weight * target;
  right_[i + 2] += weight * target;
}

std::vector<double> PentadiagonalFit::solve() const {
  PentadiagonalMatrix factors = matrix_;
  factors.factorise();
  std::vector<double> x(right_);
  factors.solve(x.data(), x.data(), 1, std::array{0});
  return x;
}

std::vector<double> smoothed(const std::vector<double>& y, double strength) {
  PentadiagonalFit fit(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) fit.add_value(i, 1.0, y[i]);
  for (std::size_t i = 0; i + 2 < y.size(); ++i) fit.add_second_difference(i, strength, 0.0);
  return fit.solve();
}

}  // namespace retarget
