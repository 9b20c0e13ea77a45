#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace retarget {

/// What a box QP took and how well it ended.
struct BoxQpStats {
  int factorizations = 0;  ///< Cholesky factorisations, 1 when no bound was reached.
  int active = 0;          ///< Variables at a bound in the solution.
  bool converged = true;  ///< False only where H is not positive definite or a value is not finite.
};

/// Exact solver of small dense box-constrained quadratic programs
///     minimise 1/2 x'Hx + g'x   subject to   lower <= x <= upper
/// with H symmetric positive definite.
///
/// Primal active set in the way of Stark and Parker, "Bounded-variable least squares: an algorithm
/// and applications" (1995), after Lawson and Hanson: start from the unconstrained minimum clamped
/// to the box; minimise over the free variables; walk to that minimum until the first bound that
/// blocks; when none does, release the bound variable whose gradient points inward most. Each
/// round lowers the objective, so it ends. (Clamping all violators at once without the walk may
/// cycle.)
///
/// Owns its scratch memory: no allocation after construction.
class BoxQp {
 public:
  /// @param size  number of variables, more than 0.
  explicit BoxQp(int size);

  /// @param H      size x size; the lower triangle is read.
  /// @param lower  size; -infinity for none. lower <= upper.
  /// @param x      size; the minimiser, inside the box exactly.
  BoxQpStats solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::VectorXd& lower,
                   const Eigen::VectorXd& upper, Eigen::VectorXd& x);

 private:
  enum class Side : signed char { kLower = -1, kFree = 0, kUpper = 1 };

  bool minimise_over_free(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                          const Eigen::VectorXd& x);
  int walk_to_minimum(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                      Eigen::VectorXd& x);
  int variable_to_release(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                          const Eigen::VectorXd& x, double tolerance);

  int size_;
  std::vector<Side> side_;
  std::vector<char> stuck_;  // released without leaving its bound: rounding, not descent
  std::vector<int> free_;
  Eigen::MatrixXd factor_;   // Cholesky factor of the free block, in its top left corner
  Eigen::VectorXd minimum_;  // of the free variables, in the order of free_
  Eigen::VectorXd gradient_;
};

/// Largest violation of the optimality conditions of a box QP at x: distance outside the box,
/// gradient of variables inside it, gradient that points inward at a bound. Zero at the solution.
[[nodiscard]] double box_qp_residual(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                                     const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                     const Eigen::VectorXd& x);

}  // namespace retarget
