#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

namespace retarget {

/// Where a variable of a box QP is held.
enum class BoundSide : signed char { kLower = -1, kFree = 0, kUpper = 1 };

/// Puts a value inside its bounds; where it was outside, on which side.
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

/// How much a bound variable wants to leave its bound for the inside; not above 0: it stays.
inline double inward_pull(BoundSide side, double gradient) {
  return side == BoundSide::kLower ? -gradient : gradient;
}

/// Primal active-set method for strictly convex box QPs
///     minimise 1/2 x'Hx + g'x   subject to   lower <= x <= upper
/// after Stark and Parker, "Bounded-variable least squares: an algorithm and applications" (1995)
/// and Lawson and Hanson: minimise over the free variables; walk to that minimum until the first
/// bound that blocks; when none does, release the bound variable whose gradient points inward
/// most. Each round lowers the objective, so it ends.
///
/// How H is stored and factorised is the system's business:
///
///     bool minimise(const std::vector<BoundSide>& sides, const VectorXd& x, VectorXd& minimum);
///         // free entries of `minimum`: the minimum with the bound variables held at x
///     double gradient(int i, const VectorXd& x);   // entry i of Hx + g
///     double gradient_scale();                     // magnitude of g, for tolerances
///
/// Begins with the variables bound that the problem before had bound, at their new bounds: where
/// problems follow each other closely, one factorization then often does. The minimum is the same
/// wherever it begins.
///
/// Owns its scratch memory: no allocation after construction.
class ActiveSet {
 public:
  explicit ActiveSet(int size)
      : size_(size), sides_(size, BoundSide::kFree), stuck_(size), minimum_(size) {}

  struct Outcome {
    int factorizations = 0;
    bool converged = true;
  };

  [[nodiscard]] const std::vector<BoundSide>& sides() const { return sides_; }
  [[nodiscard]] int active_count() const {
    return static_cast<int>(
        std::ranges::count_if(sides_, [](BoundSide side) { return side != BoundSide::kFree; }));
  }

  /// Forgets the problem before: the next one begins with all variables free.
  void reset() { std::ranges::fill(sides_, BoundSide::kFree); }
  /// The next problem begins with these variables bound, one for each.
  void begin_with(std::span<const BoundSide> sides) { std::ranges::copy(sides, sides_.begin()); }

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
  std::vector<char> stuck_;  // released without leaving its bound: rounding, not descent
  Eigen::VectorXd minimum_;
};

template <typename System>
ActiveSet::Outcome ActiveSet::solve(System& system, const Eigen::VectorXd& lower,
                                    const Eigen::VectorXd& upper, Eigen::VectorXd& x) {
  // rounds per variable after which rounding, not descent, must be driving the active set
  constexpr int kRoundsPerVariable = 20;
  // a multiplier counts as wrong beyond this share of the largest gradient entry
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
  for (int round = 0; round < kRoundsPerVariable * size_; ++round) {
    if (!at_minimum) {
      ++outcome.factorizations;
      if (!system.minimise(sides_, x, minimum_)) {
        outcome.converged = false;
        return outcome;
      }
      const int blocked = walk_to_minimum(lower, upper, x);
      if (blocked >= 0) {
        // a variable that goes straight back to its bound was released by rounding alone
        if (blocked == released) stuck_[blocked] = 1;
        released = -1;
        continue;
      }
    }
    at_minimum = false;
    // the last release made way: what was stuck before may be free to move now
    if (released >= 0) std::ranges::fill(stuck_, 0);
    released = variable_to_release(system, x, tolerance);
    if (released < 0) return outcome;
    sides_[released] = BoundSide::kFree;
  }
  outcome.converged = false;
  return outcome;
}

// binds what is outside the box; whether anything was
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

// moves the free variables towards their minimum up to the first bound; that variable, or -1
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
    // rounding must not carry a neighbour of the blocking variable out of the box
    x[i] = std::clamp(there, lower[i], upper[i]);
  }
  if (blocked >= 0) {
    const bool at_lower = minimum_[blocked] < lower[blocked];
    sides_[blocked] = at_lower ? BoundSide::kLower : BoundSide::kUpper;
    x[blocked] = at_lower ? lower[blocked] : upper[blocked];
  }
  return blocked;
}

// the bound variable whose release lowers the objective fastest, or -1 at the solution
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
