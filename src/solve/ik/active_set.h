#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

namespace retarget {

/// The active bound of a variable of a box QP.
enum class BoundSide : signed char { kLower = -1, kFree = 0, kUpper = 1 };

/// Clamps a value to its bounds.
/// @return the violated bound, or kFree.
inline BoundSide clamp_to_bounds(double& value, double lower, double upper) {
  if (value < lower) {
    value = lower;
    return BoundSide::kLower;
  }
  if (value > upper) {
    value = upper;
    return BoundSide::kUpper;
  }
  return BoundSide::kFree;
}

/// Rate at which the objective decreases when a bound variable moves inside (the negative Lagrange
/// multiplier). If it is not positive, the variable stays at its bound.
/// @param gradient  derivative of the objective with respect to the variable.
inline double inward_pull(BoundSide side, double gradient) {
  return side == BoundSide::kLower ? -gradient : gradient;
}

/// Primal active-set method for strictly convex box QPs
///     minimise 1/2 x'Hx + g'x   subject to   lower <= x <= upper
/// after Stark and Parker, "Bounded-variable least squares: an algorithm and applications" (1995)
/// and Lawson and Hanson. Each iteration minimises over the free variables and moves to that
/// minimum, up to the first blocking bound. If no bound blocks, it releases the bound variable with
/// the largest inward_pull(). Each iteration lowers the objective, so the method terminates.
///
/// The `System` of solve() determines the storage and factorisation of H:
///
///     bool minimise(const std::vector<BoundSide>& sides, const VectorXd& x, VectorXd& minimum);
///         // writes the minimiser, with the bound variables fixed at x, to the free entries of
///         // `minimum`; returns false if the free block of H is not positive definite
///     double gradient(int i, const VectorXd& x);   // entry i of Hx + g
///     double gradient_scale();                     // magnitude of g, for tolerances
///
/// solve() starts with the active set of the previous problem at the new bounds (warm start). For
/// similar consecutive problems, one factorisation is often enough. The minimiser does not depend
/// on the start.
///
/// Owns its scratch memory and does not allocate after construction.
class ActiveSet {
 public:
  explicit ActiveSet(int size)
      : size_(size), sides_(size, BoundSide::kFree), stuck_(size), minimum_(size) {}

  /// Result of solve().
  struct Outcome {
    int factorizations = 0;
    bool converged = true;  ///< False if minimise() failed or the iteration limit was reached.
  };

  [[nodiscard]] const std::vector<BoundSide>& sides() const { return sides_; }

  /// Sets the number of variables of the next problems, at most that of the constructor.
  void resize(int size) { size_ = size; }
  /// Makes the next problem start with all variables free.
  void reset() { std::ranges::fill(sides_, BoundSide::kFree); }
  /// Makes the next problem start with these sides, one per variable.
  void begin_with(std::span<const BoundSide> sides) { std::ranges::copy(sides, sides_.begin()); }

  /// Solves a problem. @param x  receives the minimiser.
  template <typename System>
  Outcome solve(System& system, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                Eigen::VectorXd& x);

 private:
  bool clamp_to_box(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, Eigen::VectorXd& x);
  int walk_to_minimum(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                      Eigen::VectorXd& x);
  template <typename System>
  int variable_to_release(System& system, const Eigen::VectorXd& x, double tolerance);

  int size_;
  std::vector<BoundSide> sides_;
  // By variable: returns to its bound after its release, due to rounding.
  std::vector<char> stuck_;
  Eigen::VectorXd minimum_;
};

template <typename System>
ActiveSet::Outcome ActiveSet::solve(System& system, const Eigen::VectorXd& lower,
                                    const Eigen::VectorXd& upper, Eigen::VectorXd& x) {
  // Limit of the iterations. Beyond it, the active set changes due to rounding only.
  constexpr int kRoundsPerVariable = 20;
  // Tolerance for multipliers, relative to System::gradient_scale().
  constexpr double kMultiplierTolerance = 1e-14;

  Outcome outcome{1, true};
  std::ranges::fill(stuck_, 0);
  for (int i = 0; i < size_; ++i) {
    x[i] = sides_[i] == BoundSide::kLower   ? lower[i]
           : sides_[i] == BoundSide::kUpper ? upper[i]
                                            : 0.0;
  }
  outcome.converged = system.minimise(sides_, x, minimum_);
  if (!outcome.converged) return outcome;
  for (int i = 0; i < size_; ++i) {
    if (sides_[i] == BoundSide::kFree) x[i] = minimum_[i];
  }
  bool at_minimum = !clamp_to_box(lower, upper, x);

  const double tolerance = kMultiplierTolerance * system.gradient_scale();
  int released = -1;
  BoundSide left = BoundSide::kFree;  // The bound of the released variable.
  for (int round = 0; round < kRoundsPerVariable * size_; ++round) {
    if (!at_minimum) {
      ++outcome.factorizations;
      if (!system.minimise(sides_, x, minimum_)) {
        outcome.converged = false;
        return outcome;
      }
      const int blocked = walk_to_minimum(lower, upper, x);
      if (blocked >= 0) {
        // A variable that returns directly to its bound was released due to rounding. A variable
        // that crosses the box to its other bound was not.
        if (blocked == released && sides_[blocked] == left) stuck_[blocked] = 1;
        released = -1;
        continue;
      }
    }
    at_minimum = false;
    // The last release lowered the objective, so that a release of stuck variables may succeed now.
    if (released >= 0) std::ranges::fill(stuck_, 0);
    released = variable_to_release(system, x, tolerance);
    if (released < 0) return outcome;
    left = sides_[released];
    sides_[released] = BoundSide::kFree;
  }
  outcome.converged = false;
  return outcome;
}

// Clamps all variables outside the box to their bounds and makes these active.
// @return whether a variable was outside.
inline bool ActiveSet::clamp_to_box(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                    Eigen::VectorXd& x) {
  bool any = false;
  for (int i = 0; i < size_; ++i) {
    const BoundSide side = clamp_to_bounds(x[i], lower[i], upper[i]);
    if (side == BoundSide::kFree) continue;
    sides_[i] = side;
    any = true;
  }
  return any;
}

// Moves the free variables towards their minimum, up to the first bound.
// @return the blocking variable, or -1.
inline int ActiveSet::walk_to_minimum(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                      Eigen::VectorXd& x) {
  double length = 1.0;
  int blocked = -1;
  for (int i = 0; i < size_; ++i) {
    if (sides_[i] != BoundSide::kFree) continue;
    double reach = 1.0;
    if (minimum_[i] < lower[i]) {
      reach = (lower[i] - x[i]) / (minimum_[i] - x[i]);
    } else if (minimum_[i] > upper[i]) {
      reach = (upper[i] - x[i]) / (minimum_[i] - x[i]);
    } else {
      continue;
    }
    if (blocked < 0 || reach < length) {
      length = reach;
      blocked = i;
    }
  }
  for (int i = 0; i < size_; ++i) {
    if (sides_[i] != BoundSide::kFree) continue;
    const double there = blocked < 0 ? minimum_[i] : x[i] + length * (minimum_[i] - x[i]);
    // Rounding must not move another variable out of the box.
    x[i] = std::clamp(there, lower[i], upper[i]);
  }
  if (blocked >= 0) {
    const bool at_lower = minimum_[blocked] < lower[blocked];
    sides_[blocked] = at_lower ? BoundSide::kLower : BoundSide::kUpper;
    x[blocked] = at_lower ? lower[blocked] : upper[blocked];
  }
  return blocked;
}

// @return the bound variable whose release lowers the objective fastest, or -1 at the solution.
template <typename System>
int ActiveSet::variable_to_release(System& system, const Eigen::VectorXd& x, double tolerance) {
  int chosen = -1;
  double worst = tolerance;
  for (int i = 0; i < size_; ++i) {
    if (sides_[i] == BoundSide::kFree || stuck_[i] != 0) continue;
    const double inward = inward_pull(sides_[i], system.gradient(i, x));
    if (inward > worst) {
      worst = inward;
      chosen = i;
    }
  }
  return chosen;
}

}  // namespace retarget
