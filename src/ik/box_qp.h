#pragma once

#include <Eigen/Core>
#include <memory>

namespace retarget {

/// What a box QP took and how well it ended.
struct BoxQpStats {
  int factorizations = 0;  ///< Cholesky factorisations, 1 when no bound was reached.
  int active = 0;          ///< Variables at a bound in the solution.
  /// False where H is not positive definite, a value is not finite, or rounding keeps the active
  /// set from settling.
  bool converged = true;
};

/// Exact solver of small dense box-constrained quadratic programs
///     minimise 1/2 x'Hx + g'x   subject to   lower <= x <= upper
/// with H symmetric positive definite: Cholesky on the free variables, primal active set with a
/// ratio test (docs/ik.md).
///
/// Owns its scratch memory: no allocation after construction.
class BoxQp {
 public:
  /// @param size  number of variables, more than 0.
  explicit BoxQp(int size);
  ~BoxQp();

  /// @param H      size x size; the lower triangle is read.
  /// @param lower  size; -infinity for none. lower <= upper.
  /// @param x      size; the minimiser, inside the box exactly.
  BoxQpStats solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::VectorXd& lower,
                   const Eigen::VectorXd& upper, Eigen::VectorXd& x);

 private:
  class Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace retarget
