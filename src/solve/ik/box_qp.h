#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "base/math/least_squares.h"

namespace retarget {

/// Solver statistics.
struct BoxQpStats {
  int factorizations = 0;  ///< Cholesky factorizations; 1 if no bound was reached.
  int active = 0;          ///< Number of variables at a bound in the solution.
  /// False if H is not positive definite, a value is not finite, or rounding keeps the active set
  /// from settling.
  bool converged = true;
};

/// Exact solver of small dense box-constrained quadratic programs
///     minimise 1/2 x'Hx + g'x   subject to   lower <= x <= upper
/// with H symmetric positive definite: Cholesky on the free variables, primal active set with a
/// ratio test (docs/ik.md).
///
/// Owns its scratch memory and does not allocate after construction.
class BoxQp {
 public:
  /// @param size  largest number of variables, > 0.
  explicit BoxQp(int size);
  ~BoxQp();

  /// @param H      size x size, at most that of the constructor; only the lower triangle is read.
  /// @param lower  size; -infinity if unbounded. lower <= upper.
  /// @param x      size; receives the minimiser, which is finite and inside the box exactly. If a
  ///     value of H or g is not finite, x is the point of the box nearest to 0.
  BoxQpStats solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::VectorXd& lower,
                   const Eigen::VectorXd& upper, Eigen::VectorXd& x);

 private:
  class Workspace;
  std::unique_ptr<Workspace> workspace_;
};

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
