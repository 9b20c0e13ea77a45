#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "base/math/least_squares.h"

namespace retarget {

/// Solver statistics.
struct BoxQpStats {
  int factorizations = 0;  ///< Cholesky factorizations; 1 if no bound was reached.
  /// False if H is not positive definite, a value is not finite, or the active set does not
  /// converge due to rounding.
  bool converged = true;
};

/// Exact solver of small dense box-constrained quadratic programs
///     minimise 1/2 x'Hx + g'x   subject to   lower <= x <= upper
/// with H symmetric positive definite. It uses a primal active-set method (ActiveSet) with a
/// Cholesky factorisation of the free block (docs/ik.md).
///
/// Owns its scratch memory and does not allocate after construction.
class BoxQp {
 public:
  /// @param size  largest number of variables, > 0.
  explicit BoxQp(int size);
  ~BoxQp();

  /// Solves a problem of n variables, at most the size of the constructor.
  /// @param H             n x n; reads only the lower triangle.
  /// @param g             n values.
  /// @param lower, upper  n values, lower <= upper; -+infinity if unbounded.
  /// @param x             n values; receives the minimiser, which is finite and exactly inside the
  ///     box. If a value of H or g is not finite, x is the point of the box nearest to 0.
  BoxQpStats solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::VectorXd& lower,
                   const Eigen::VectorXd& upper, Eigen::VectorXd& x);

 private:
  class Workspace;
  std::unique_ptr<Workspace> workspace_;
};

/// Linear system of a small dense least-squares problem. Solves exactly for the damped Gauss-Newton
/// step inside a box. Provides solve() of LeastSquaresProblem. The problem must fill hessian,
/// gradient, lower and upper before the call.
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
  Eigen::VectorXd unit;          ///< Unit of the damping, by variable; 1 by default.
  Eigen::VectorXd step;          ///< The solution.

 private:
  Eigen::MatrixXd damped_;
  BoxQp qp_;
};

}  // namespace retarget
