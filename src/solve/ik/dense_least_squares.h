#pragma once

#include <Eigen/Core>
#include <optional>

#include "base/math/least_squares.h"
#include "solve/ik/box_qp.h"

namespace retarget {

/// Linear system of a small dense least-squares problem: the damped Gauss-Newton step inside a box,
/// solved exactly. Provides solve() of LeastSquaresProblem; the problem fills the members before.
///
/// Does not allocate after construction.
struct DenseLeastSquares {
  /// @param size  number of variables, > 0.
  explicit DenseLeastSquares(int size);

  /// Minimises 1/2 step' (hessian + damping / unit^2) step + gradient' step inside the box.
  /// @return the Euclidean norm of the step; NaN if a value of the system is not finite.
  std::optional<double> solve(double damping);

  Eigen::MatrixXd hessian;  ///< Only the lower triangle is read.
  Eigen::VectorXd gradient;
  Eigen::VectorXd lower, upper;  ///< Bounds of the step.
  Eigen::VectorXd unit;          ///< By variable: its scale for the damping, 1 unless changed.
  Eigen::VectorXd step;          ///< The result.

 private:
  Eigen::MatrixXd damped_;
  BoxQp qp_;
};

}  // namespace retarget
