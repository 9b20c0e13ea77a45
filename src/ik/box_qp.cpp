#include "retarget/ik/box_qp.h"

#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

// a multiplier counts as wrong beyond this share of the largest gradient entry
constexpr double kMultiplierTolerance = 1e-14;
// rounds per variable after which rounding, not descent, must be driving the active set
constexpr int kRoundsPerVariable = 20;

// row `row` of the symmetric matrix whose lower triangle is stored, times x
double symmetric_row_times(const Eigen::MatrixXd& H, int row, const Eigen::VectorXd& x) {
  const auto size = static_cast<int>(x.size());
  return H.row(row).head(row + 1).dot(x.head(row + 1)) +
         H.col(row).tail(size - row - 1).dot(x.tail(size - row - 1));
}

}  // namespace

BoxQp::BoxQp(int size)
    : size_(size),
      side_(size, Side::kFree),
      stuck_(size, 0),
      factor_(size, size),
      minimum_(size),
      gradient_(size) {
  free_.reserve(size);
}

BoxQpStats BoxQp::solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                        const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                        Eigen::VectorXd& x) {
  BoxQpStats stats;
  std::fill(side_.begin(), side_.end(), Side::kFree);
  std::fill(stuck_.begin(), stuck_.end(), 0);

  // unconstrained minimum, clamped to the box
  x.setZero();
  ++stats.factorizations;
  stats.converged = minimise_over_free(H, g, x);
  if (stats.converged) x = minimum_;
  for (int i = 0; i < size_; ++i) {
    if (x[i] < lower[i]) {
      x[i] = lower[i];
      side_[i] = Side::kLower;
      ++stats.active;
    } else if (x[i] > upper[i]) {
      x[i] = upper[i];
      side_[i] = Side::kUpper;
      ++stats.active;
    }
  }
  if (stats.active == 0 || !stats.converged) return stats;

  const double tolerance = kMultiplierTolerance * g.cwiseAbs().maxCoeff();
  int released = -1;
  for (int round = 0; round < kRoundsPerVariable * size_; ++round) {
    ++stats.factorizations;
    if (!minimise_over_free(H, g, x)) {
      stats.converged = false;
      break;
    }
    const int blocked = walk_to_minimum(lower, upper, x);
    if (blocked >= 0) {
      // a variable that goes straight back to its bound was released by rounding alone
      if (blocked == released) stuck_[blocked] = 1;
      released = -1;
      continue;
    }
    // the last release made way: what was stuck before may be free to move now
    if (released >= 0) std::fill(stuck_.begin(), stuck_.end(), 0);
    released = variable_to_release(H, g, x, tolerance);
    if (released < 0) break;
    side_[released] = Side::kFree;
  }
  stats.active = static_cast<int>(
      std::count_if(side_.begin(), side_.end(), [](Side side) { return side != Side::kFree; }));
  return stats;
}

// minimum over the free variables with the others held at x
bool BoxQp::minimise_over_free(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                               const Eigen::VectorXd& x) {
  free_.clear();
  for (int i = 0; i < size_; ++i) {
    if (side_[i] == Side::kFree) free_.push_back(i);
  }
  const auto count = static_cast<int>(free_.size());
  auto block = factor_.topLeftCorner(count, count);
  auto right = minimum_.head(count);
  for (int a = 0; a < count; ++a) {
    const int i = free_[a];
    for (int b = 0; b <= a; ++b) block(a, b) = H(i, free_[b]);
    double sum = -g[i];
    for (int j = 0; j < size_; ++j) {
      if (side_[j] != Side::kFree) sum -= (i > j ? H(i, j) : H(j, i)) * x[j];
    }
    right[a] = sum;
  }
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Lower> cholesky(block);
  if (cholesky.info() != Eigen::Success) return false;
  cholesky.solveInPlace(right);
  return right.allFinite();
}

// moves the free variables towards their minimum up to the first bound; that variable, or -1
int BoxQp::walk_to_minimum(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                           Eigen::VectorXd& x) {
  const auto count = static_cast<int>(free_.size());
  double length = 1.0;
  int blocked = -1;
  for (int a = 0; a < count; ++a) {
    const int i = free_[a];
    const double step = minimum_[a] - x[i];
    double reach = 1.0;
    if (minimum_[a] < lower[i]) {
      reach = (lower[i] - x[i]) / step;
    } else if (minimum_[a] > upper[i]) {
      reach = (upper[i] - x[i]) / step;
    } else {
      continue;
    }
    if (blocked < 0 || reach < length) {
      length = reach;
      blocked = i;
    }
  }
  for (int a = 0; a < count; ++a) {
    const int i = free_[a];
    x[i] = blocked < 0 ? minimum_[a] : x[i] + length * (minimum_[a] - x[i]);
    // rounding must not carry a neighbour of the blocking variable out of the box
    x[i] = std::clamp(x[i], lower[i], upper[i]);
  }
  if (blocked >= 0) {
    const bool at_lower =
        std::abs(x[blocked] - lower[blocked]) <= std::abs(x[blocked] - upper[blocked]);
    side_[blocked] = at_lower ? Side::kLower : Side::kUpper;
    x[blocked] = at_lower ? lower[blocked] : upper[blocked];
  }
  return blocked;
}

// the bound variable whose release lowers the objective fastest, or -1 at the solution
int BoxQp::variable_to_release(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                               const Eigen::VectorXd& x, double tolerance) {
  int chosen = -1;
  double worst = tolerance;
  for (int i = 0; i < size_; ++i) {
    if (side_[i] == Side::kFree || stuck_[i] != 0) continue;
    gradient_[i] = g[i] + symmetric_row_times(H, i, x);
    const double inward = side_[i] == Side::kLower ? -gradient_[i] : gradient_[i];
    if (inward > worst) {
      worst = inward;
      chosen = i;
    }
  }
  return chosen;
}

double box_qp_residual(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                       const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                       const Eigen::VectorXd& x) {
  double residual = 0.0;
  for (int i = 0; i < x.size(); ++i) {
    const double gradient = g[i] + symmetric_row_times(H, i, x);
    // at a bound only a gradient that points inward is a fault
    double fault = std::abs(gradient);
    if (x[i] <= lower[i]) fault = std::max(0.0, -gradient);
    if (x[i] >= upper[i]) fault = std::min(fault, std::max(0.0, gradient));
    residual = std::max({residual, fault, lower[i] - x[i], x[i] - upper[i]});
  }
  return residual;
}

}  // namespace retarget
