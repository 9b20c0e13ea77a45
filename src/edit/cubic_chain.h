#pragma once

#include <Eigen/Core>
#include <vector>

namespace retarget {

/// Cubics over intervals of a parameter, joined with continuous derivatives.
struct CubicChain {
  std::vector<double> knots;  ///< Increasing.
  /// Per knot: the place in the first row, the derivative in the second.
  std::vector<Eigen::Matrix2d> nodes;

  [[nodiscard]] std::size_t piece_of(double parameter) const;
  [[nodiscard]] Eigen::Vector2d at(double parameter) const;
  /// Bezier control points, 3 pieces + 1.
  [[nodiscard]] std::vector<Eigen::Vector2d> control_points() const;
};

/// The chain nearest to points at parameters, by weighted least squares.
/// @param knots  two or more; they enclose the parameters.
[[nodiscard]] CubicChain fit_cubic_chain(std::vector<double> knots,
                                         const std::vector<double>& parameters,
                                         const std::vector<Eigen::Vector2d>& points,
                                         const std::vector<double>& weights);

}  // namespace retarget
