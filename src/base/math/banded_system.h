#pragma once

#include <cstddef>
#include <optional>
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

/// Weighted least squares for a track of numbers: its values, first differences and second
/// differences may each have a target. The normal equations have five diagonals, so a solution
/// takes time proportional to the track's length.
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
  // Entries on the diagonal i, and those that couple i to i + 1 and to i + 2.
  std::vector<double> diagonal_, next_, second_, right_;
};

/// Minimises sum (x - y)^2 + strength * sum (second difference of x)^2: a low-pass without delay whose
/// gain is one half at angular frequency strength^(-1/4) rad per sample.
[[nodiscard]] std::vector<double> smoothed(const std::vector<double>& y, double strength);

}  // namespace retarget
