#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace retarget {

/// Linear system H x = b with a symmetric positive definite band matrix: entries (i, j) with
/// |i - j| >= width are zero. Solves it by Cholesky factorisation, which fills no entry outside the
/// band, in time proportional to size * width^2.
class BandedSystem {
 public:
  /// Starts a system of zeros. Allocates only if it is larger than all before.
  /// @param width  1 for a diagonal matrix.
  void begin(std::size_t size, std::size_t width);

  /// Row i of the lower triangle: row(i)[j] is entry (i, j) for i - width < j <= i.
  [[nodiscard]] double* row(std::size_t i) { return entries_.data() + (i + 1) * (width_ - 1); }
  [[nodiscard]] const std::vector<double>& right() const { return right_; }
  [[nodiscard]] std::vector<double>& right() { return right_; }

  /// Solves for the variables in [first, last) and leaves the others out: they are zero. Replaces H
  /// by its factor and b, see right(), by the solution.
  /// @return the largest component of the solution, NaN if a value is not finite; nothing if H is
  ///     not positive definite.
  std::optional<double> solve(std::size_t first, std::size_t last);

 private:
  std::size_t width_ = 1;
  std::vector<double> entries_, right_;
  std::vector<double> column_;  // Of the factor, below the diagonal.
};

/// The normal matrix of weighted least squares over values of a track, first differences and second
/// differences: symmetric, with five diagonals. Factorised as L D L' in time proportional to its
/// size.
class PentadiagonalMatrix {
 public:
  /// Starts a matrix of zeros. Allocates only if it is larger than all before.
  void begin(std::size_t size) { rows_.assign(size, {}); }

  /// Adds the term weight * x[i]^2.
  void add_value(std::size_t i, double weight) { rows_[i].diagonal += weight; }
  /// Adds the term weight * (x[i + 1] - x[i])^2.
  void add_difference(std::size_t i, double weight);
  /// Adds the term weight * (x[i] - 2 x[i + 1] + x[i + 2])^2.
  void add_second_difference(std::size_t i, double weight);

  /// Sum of the absolute values of row i. The diagonal matrix of these sums is an upper bound of the
  /// matrix (Gershgorin). Only before factorise().
  [[nodiscard]] double absolute_row_sum(std::size_t i) const;

  /// Replaces the matrix by its factors.
  /// @pre it is positive definite: for instance, each value has a positive weight
  void factorise();
  /// Solves for some columns of a row-major matrix with `stride` columns, after factorise().
  /// @param right, x  right-hand sides and solutions; they may be the same.
  void solve(const double* right, double* x, std::size_t stride,
             std::span<const int> columns) const;

 private:
  // Entries on the diagonal i, and those that couple i to i + 1 and to i + 2; after factorise(),
  // those of D and L.
  struct Row {
    double diagonal = 0.0, next = 0.0, second = 0.0;
  };
  std::vector<Row> rows_;
};

/// Weighted least squares for a track of numbers: its values, first differences and second
/// differences may each have a target.
class PentadiagonalFit {
 public:
  explicit PentadiagonalFit(std::size_t count);

  /// Adds weight * (x[i] - target)^2.
  void add_value(std::size_t i, double weight, double target);
  /// Adds weight * (x[i + 1] - x[i] - target)^2.
  void add_difference(std::size_t i, double weight, double target);
  /// Adds weight * (x[i] - 2 x[i + 1] + x[i + 2] - target)^2.
  void add_second_difference(std::size_t i, double weight, double target);

  /// Returns the track with the least sum.
  /// @pre the terms determine it: for instance, each value has a target of positive weight
  [[nodiscard]] std::vector<double> solve() const;

 private:
  PentadiagonalMatrix matrix_;
  std::vector<double> right_;
};

/// Minimises sum (x - y)^2 + strength * sum (second difference of x)^2: a low-pass without delay whose
/// gain is one half at angular frequency strength^(-1/4) rad per sample.
[[nodiscard]] std::vector<double> smoothed(const std::vector<double>& y, double strength);

}  // namespace retarget
