#include "solve/fit/banded_smoother.h"

#include <cmath>

#include "solve/fit/shorthand.h"

namespace retarget {

void BandedSmoother::reset(int count) {
  rows_.assign(at(count), {});
}

void BandedSmoother::add(int first, double weight, std::initializer_list<double> coefficients) {
  const double* const c = coefficients.begin();
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    Row& row = rows_[at(first) + i];
    row.diagonal += weight * c[i] * c[i];
    if (i >= 1) row.before += weight * c[i] * c[i - 1];
    if (i >= 2) row.before_that += weight * c[i] * c[i - 2];
  }
}

double BandedSmoother::bound(int row) const {
  const std::size_t i = at(row);
  double sum = rows_[i].diagonal - 1.0 + std::abs(rows_[i].before) + std::abs(rows_[i].before_that);
  if (i + 1 < rows_.size()) sum += std::abs(rows_[i + 1].before);
  if (i + 2 < rows_.size()) sum += std::abs(rows_[i + 2].before_that);
  return sum;
}

void BandedSmoother::factorise() {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Row& row = rows_[i];
    if (i >= 2) {
      const Row& earlier = rows_[i - 2];
      row.before -= row.before_that * rows_[i - 1].before;
      row.diagonal -= square(row.before_that) / earlier.diagonal;
      row.before_that /= earlier.diagonal;
    }
    if (i >= 1) {
      row.diagonal -= square(row.before) / rows_[i - 1].diagonal;
      row.before /= rows_[i - 1].diagonal;
    }
  }
}

void BandedSmoother::solve(const double* v, double* s, std::size_t stride,
                           std::span<const int> columns) const {
  const std::size_t count = rows_.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (const int column : columns) {
      const std::size_t here = i * stride + at(column);
      double value = v[here];
      if (i >= 1) value -= rows_[i].before * s[here - stride];
      if (i >= 2) value -= rows_[i].before_that * s[here - 2 * stride];
      s[here] = value;
    }
  }
  for (std::size_t i = count; i-- > 0;) {
    for (const int column : columns) {
      const std::size_t here = i * stride + at(column);
      double value = s[here] / rows_[i].diagonal;
      if (i + 1 < count) value -= rows_[i + 1].before * s[here + stride];
      if (i + 2 < count) value -= rows_[i + 2].before_that * s[here + 2 * stride];
      s[here] = value;
    }
  }
}

}  // namespace retarget
