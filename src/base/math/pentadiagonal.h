#pragma once

#include <cstddef>
#include <vector>

namespace retarget {

/// Weighted least squares for a track of numbers: its values, its differences and its second
/// differences may each have a target. The normal equations have five diagonals, so that a solution
/// takes time in proportion to the track's length.
class PentadiagonalFit {
 public:
  explicit PentadiagonalFit(std::size_t count);

  /// Adds weight * (x[i] - target)^2.
  void add_value(std::size_t i, double weight, double target);
  /// Adds weight * (x[i + 1] - x[i] - target)^2.
  void add_difference(std::size_t i, double weight, double target);
  /// Adds weight * (x[i] - 2 x[i + 1] + x[i + 2] - target)^2.
  void add_second_difference(std::size_t i, double weight, double target);

  /// The track with the least sum.
  /// @pre the terms determine it: for instance, each value has a target of positive weight
  [[nodiscard]] std::vector<double> solve() const;

 private:
  // diagonal i, and what couples i to i + 1 and to i + 2
  std::vector<double> diagonal_, next_, second_, right_;
};

/// Minimises sum (x - y)^2 + strength * sum (second difference of x)^2: a low-pass without delay whose
/// gain is one half at angular frequency strength^(-1/4) rad per sample.
[[nodiscard]] std::vector<double> smoothed(const std::vector<double>& y, double strength);

}  // namespace retarget
