#include "edit/cubic_chain.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

namespace retarget {
namespace {

using Eigen::Matrix2d;
using Eigen::RowVector2d;

// Weights of position and derivative at both ends of a piece.
struct Basis {
  RowVector2d left, right;
};

Basis basis_at(double u, double length) {
  const double v = 1.0 - u;
  return {{v * v * (1.0 + 2.0 * u), length * u * v * v},
          {u * u * (1.0 + 2.0 * v), -length * u * u * v}};
}

// Symmetric block-tridiagonal equations with 2 x 2 blocks.
struct BlockEquations {
  std::vector<Matrix2d> diagonal, above, right_side;

  explicit BlockEquations(std::size_t size)
      : diagonal(size, Matrix2d::Zero()), above(diagonal), right_side(diagonal) {}

  void add(std::size_t piece, const Basis& row, const Eigen::RowVector2d& value, double weight) {
    diagonal[piece] += weight * row.left.transpose() * row.left;
    diagonal[piece + 1] += weight * row.right.transpose() * row.right;
    above[piece] += weight * row.left.transpose() * row.right;
    right_side[piece] += weight * row.left.transpose() * value;
    right_side[piece + 1] += weight * row.right.transpose() * value;
  }

  std::vector<Matrix2d> solve() {
    const std::size_t size = diagonal.size();
    for (std::size_t i = 1; i < size; ++i) {
      const Matrix2d factor = above[i - 1].transpose() * diagonal[i - 1].inverse();
      diagonal[i] -= factor * above[i - 1];
      right_side[i] -= factor * right_side[i - 1];
    }
    std::vector<Matrix2d> result(size);
    for (std::size_t i = size; i-- > 0;) {
      Matrix2d rest = right_side[i];
      if (i + 1 < size) rest -= above[i] * result[i + 1];
      result[i] = diagonal[i].inverse() * rest;
    }
    return result;
  }
};

}  // namespace

std::size_t CubicChain::piece_of(double parameter) const {
  const auto after = std::upper_bound(knots.begin() + 1, knots.end() - 1, parameter);
  return static_cast<std::size_t>(after - knots.begin()) - 1;
}

Eigen::Vector2d CubicChain::at(double parameter) const {
  const std::size_t piece = piece_of(parameter);
  const double length = knots[piece + 1] - knots[piece];
  const Basis basis = basis_at((parameter - knots[piece]) / length, length);
  return (basis.left * nodes[piece] + basis.right * nodes[piece + 1]).transpose();
}

std::vector<Eigen::Vector2d> CubicChain::control_points() const {
  std::vector<Eigen::Vector2d> points{nodes.front().row(0).transpose()};
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    const double third = (knots[i + 1] - knots[i]) / 3.0;
    points.emplace_back((nodes[i].row(0) + third * nodes[i].row(1)).transpose());
    points.emplace_back((nodes[i + 1].row(0) - third * nodes[i + 1].row(1)).transpose());
    points.emplace_back(nodes[i + 1].row(0).transpose());
  }
  return points;
}

CubicChain fit_cubic_chain(std::vector<double> knots, const std::vector<double>& parameters,
                           const std::vector<Eigen::Vector2d>& points,
                           const std::vector<double>& weights) {
  CubicChain chain{std::move(knots), {}};
  BlockEquations equations(chain.knots.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t piece = chain.piece_of(parameters[i]);
    const double length = chain.knots[piece + 1] - chain.knots[piece];
    equations.add(piece, basis_at((parameters[i] - chain.knots[piece]) / length, length),
                  points[i].transpose(), weights[i]);
  }
  // Weak regularisation: straight and even where there are no points.
  constexpr double kEven = 1e-7;
  for (std::size_t piece = 0; piece + 1 < chain.knots.size(); ++piece) {
    const double length = chain.knots[piece + 1] - chain.knots[piece];
    const RowVector2d none = RowVector2d::Zero();
    equations.add(piece, {{0.0, -1.0}, {0.0, 1.0}}, none, kEven * length);
    equations.add(piece, {{-1.0 / length, -0.5}, {1.0 / length, -0.5}}, none, kEven * length);
  }
  chain.nodes = equations.solve();
  return chain;
}

}  // namespace retarget
