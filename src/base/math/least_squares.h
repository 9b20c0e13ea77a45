#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <optional>

namespace retarget {

/// All tolerances of damped_least_squares(). The problem defines the units of damping and step
/// size.
struct LeastSquaresPolicy {
  int max_steps = 50;  ///< Number of solved systems, including those of rejected steps.

  double initial_damping = 1e-3;
  double shrink = 0.1;          ///< Factor for the damping after an accepted step.
  double growth = 10.0;         ///< Factor for the damping after a rejected step.
  double min_damping = 0.0;     ///< Least damping after an accepted step.
  double min_increased = 1e-3;  ///< Least damping after a rejected step.
  double max_damping = 1e8;     ///< The solver stalls when the damping reaches this value.

  /// Longer steps are shortened to this size.
  double max_step = std::numeric_limits<double>::infinity();
  int trials = 1;        ///< Line search: trials per step before the damping grows.
  double shorten = 0.5;  ///< Factor for the length of a step from one trial to the next.
  /// Whether a step must lower the cost. If not, every finite step is accepted, as in the
  /// Gauss-Newton method without safeguards.
  bool monotone = true;

  /// Converged if an accepted step that was not shortened to max_step changes the cost by less than
  /// relative_change * cost + absolute_change, or if the size of a step is below min_step.
  double relative_change = 0.0, absolute_change = 0.0;
  double min_step = 0.0;
};

/// Why damped_least_squares() stopped.
enum class LeastSquaresStatus {
  kConverged,
  kStepLimit,  ///< Took max_steps steps.
  kStalled,    ///< No step lowers the cost, or the damped matrix is not positive definite.
  kNonFinite,  ///< The cost of the start, the last step or its cost is not finite.
};

struct LeastSquaresResult {
  double cost = 0.0;  ///< Cost at the returned point; not finite only if that of the start is not.
  int steps = 0;      ///< Solved systems.
  LeastSquaresStatus status = LeastSquaresStatus::kStepLimit;
};

/// A nonlinear least-squares problem with its current point and the factorisation of its system:
/// DenseLeastSquares for small dense problems with bounds, BandedSystem for clips. The problem
/// keeps its step inside the bounds.
///
///     double cost();       // of the current point; called once
///     void linearise();    // computes gradient g and Gauss-Newton matrix H at the current point
///     std::optional<double> solve(double damping);
///         // computes the step that minimises 1/2 s'(H + damping D)s + g's inside the bounds;
///         // returns its size (NaN if it is not finite), or nothing if the matrix is not positive
///         // definite
///     double try_step(double length);  // cost of the current point plus length * step
///     void accept();                   // makes the point of the last try_step() the current one
///     void reject();                   // discards it
template <typename Problem>
concept LeastSquaresProblem = requires(Problem problem, double value) {
  { problem.cost() } -> std::convertible_to<double>;
  problem.linearise();
  { problem.solve(value) } -> std::convertible_to<std::optional<double>>;
  { problem.try_step(value) } -> std::convertible_to<double>;
  problem.accept();
  problem.reject();
};

/// Minimises a sum of squares by Gauss-Newton steps with Levenberg-Marquardt damping (Nocedal and
/// Wright, "Numerical Optimization", chapter 10): the damping shrinks after a step that lowers the
/// cost and grows after one that does not. Never accepts a step or a cost that is not finite. Does
/// not allocate.
template <LeastSquaresProblem Problem>
LeastSquaresResult damped_least_squares(Problem& problem, const LeastSquaresPolicy& policy) {
  using enum LeastSquaresStatus;
  LeastSquaresResult result{.cost = problem.cost()};
  if (!std::isfinite(result.cost)) {
    result.status = kNonFinite;
    return result;
  }
  double damping = policy.initial_damping;
  bool has_moved = true;
  while (result.steps < policy.max_steps) {
    if (has_moved) problem.linearise();
    ++result.steps;
    const std::optional<double> size = problem.solve(damping);
    if (size && !std::isfinite(*size)) {
      result.status = kNonFinite;
      return result;
    }
    const bool is_capped = size && *size > policy.max_step;
    double length = is_capped ? policy.max_step / *size : 1.0;
    double tried = result.cost;
    has_moved = false;
    for (int trial = 0; size && trial < policy.trials && !has_moved; ++trial) {
      tried = problem.try_step(length);
      has_moved = std::isfinite(tried) && (!policy.monotone || tried < result.cost);
      length *= policy.shorten;
    }
    bool has_converged = std::isfinite(tried) && size && *size < policy.min_step;
    if (has_moved) {
      problem.accept();
      const double change = std::abs(result.cost - tried);
      has_converged |=
          !is_capped && change < policy.relative_change * result.cost + policy.absolute_change;
      result.cost = tried;
      damping = std::max(policy.shrink * damping, policy.min_damping);
    } else {
      if (size) problem.reject();
      damping = std::max(policy.growth * damping, policy.min_increased);
    }
    if (has_converged) {
      result.status = kConverged;
      return result;
    }
    if (!(damping < policy.max_damping)) {
      result.status = std::isfinite(tried) ? kStalled : kNonFinite;
      return result;
    }
  }
  return result;
}

}  // namespace retarget
