#pragma once

#include <Eigen/Core>
#include <vector>

namespace retarget {

/// A chain of cubics over intervals of a parameter, with continuous first derivatives.
struct CubicChain {
  std::vector<double> knots;  ///< Increasing.
  /// Per knot: position in the first row, derivative in the second.
  std::vector<Eigen::Matrix2d> nodes;

  [[nodiscard]] std::size_t piece_of(double parameter) const;
  [[nodiscard]] Eigen::Vector2d at(double parameter) const;
  /// Bezier control points, 3 * pieces + 1.
  [[nodiscard]] std::vector<Eigen::Vector2d> control_points() const;
};

/// Fits a chain to points at given parameters by weighted least squares.
/// @param knots  at least two; their range contains all parameters.
[[nodiscard]] CubicChain fit_cubic_chain(std::vector<double> knots,
                                         const std::vector<double>& parameters,
                                         const std::vector<Eigen::Vector2d>& points,
                                         const std::vector<double>& weights);

}  // namespace retarget
