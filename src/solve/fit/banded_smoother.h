#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <vector>

namespace retarget {

/// Smooths sequences: computes the s that minimises |v - s|^2 plus weighted squares of differences
/// of consecutive entries of s. The matrix is symmetric, positive definite and pentadiagonal; the
/// method is its LDL' factorisation.
class BandedSmoother {
 public:
  /// Starts with no differences, so that s = v. Keeps the memory of earlier sequences.
  void reset(int count);
  /// Adds weight * (c_0 s_first + c_1 s_(first + 1) + ...)^2.
  /// @param coefficients  at most three.
  void add(int first, double weight, std::initializer_list<double> coefficients);
  /// Sum of the absolute values of a row of the differences' matrix K. By Gershgorin's theorem, the
  /// diagonal matrix of these sums is an upper bound of K. Only before factorise().
  [[nodiscard]] double bound(int row) const;
  void factorise();
  /// Computes s from v for some columns of row-major matrices with `stride` columns.
  void solve(const double* v, double* s, std::size_t stride, std::span<const int> columns) const;

 private:
  // A row of the matrix and, after factorise(), of D and L.
  struct Row {
    double diagonal = 1.0, before = 0.0, before_that = 0.0;
  };
  std::vector<Row> rows_;
};

}  // namespace retarget
