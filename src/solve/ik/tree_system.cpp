#include "solve/ik/tree_system.h"

#include <algorithm>

namespace retarget {
namespace {

// The rows do not overlap. Without __restrict, the compiler adds a run-time check that costs more
// than the sum.
void subtract_scaled(const double* __restrict row, double scale, int count,
                     double* __restrict other_row) {
  for (int i = 0; i < count; ++i) other_row[i] -= scale * row[i];
}

}  // namespace

TreeSystem::TreeSystem(const KinematicTree& tree)
    : tree_(tree),
      begin_(tree.row_begin()),
      H_(begin_.back(), 0.0),
      L_(H_),
      inverse_d_(tree.dof_count(), 0.0),
      masked_(tree.dof_count(), 0),
      g_(Eigen::VectorXd::Zero(tree.dof_count())) {}

void TreeSystem::add_to_diagonal(double value) {
  for (int i = 0; i < size(); ++i) H_[begin_[i + 1] - 1] += value;
}

int TreeSystem::last_descendant(int i) const {
  const int link = std::max(i - KinematicTree::dof_of(0), 0);
  return KinematicTree::dof_of(tree_.links()[link].last_descendant);
}

bool TreeSystem::minimise(const std::vector<BoundSide>& sides, const Eigen::VectorXd& x,
                          Eigen::VectorXd& minimum) {
  L_ = H_;
  minimum = -g_;
  for (int i = 0; i < size(); ++i) {
    masked_[i] = sides[i] != BoundSide::kFree ? 1 : 0;
    if (masked_[i] != 0) mask(i, x[i], minimum);
  }
  if (!factorise()) return false;
  solve(minimum);
  return minimum.allFinite();
}

// Removes a variable held at `value` from the system and moves its effect to the right side.
void TreeSystem::mask(int i, double value, Eigen::VectorXd& right) {
  double* const row = L_.data() + begin_[i];
  const int depth = this->depth(i);
  const int* const above = carriers(i);
  for (int k = 0; k < depth; ++k) {
    right[above[k]] -= H_[begin_[i] + k] * value;
    row[k] = 0.0;
  }
  row[depth] = 1.0;
  for (int j = i + 1, last = last_descendant(i); j <= last; ++j) {
    right[j] -= H_[begin_[j] + depth] * value;
    L_[begin_[j] + depth] = 0.0;
  }
  right[i] = value;
}

// Factorises H = L'DL in place, the last variable first.
bool TreeSystem::factorise() {
  for (int k = size() - 1; k >= 0; --k) {
    double* const row = L_.data() + begin_[k];
    const int depth = this->depth(k);
    const int* const above = carriers(k);
    if (!(row[depth] > 0.0)) return false;
    const double inverse = 1.0 / row[depth];
    inverse_d_[k] = inverse;
    if (masked_[k] != 0) continue;
    for (int m = depth - 1; m >= 0; --m) {
      const double scaled = row[m] * inverse;
      subtract_scaled(row, scaled, m + 1, L_.data() + begin_[above[m]]);
      row[m] = scaled;
    }
  }
  return true;
}

// Solves x = H^-1 x with the L'DL factors.
void TreeSystem::solve(Eigen::VectorXd& x) const {
  for (int k = size() - 1; k >= 0; --k) {
    if (masked_[k] != 0) continue;
    const double* const row = L_.data() + begin_[k];
    const int depth = this->depth(k);
    const int* const above = carriers(k);
    const double value = x[k];
    for (int m = 0; m < depth; ++m) x[above[m]] -= row[m] * value;
  }
  for (int k = 0; k < size(); ++k) {
    if (masked_[k] != 0) continue;
    const double* const row = L_.data() + begin_[k];
    const int depth = this->depth(k);
    const int* const above = carriers(k);
    double value = x[k] * inverse_d_[k];
    for (int m = 0; m < depth; ++m) value -= row[m] * x[above[m]];
    x[k] = value;
  }
}

double TreeSystem::gradient(int i, const Eigen::VectorXd& x) const {
  const int depth = this->depth(i);
  const int* const above = carriers(i);
  double sum = g_[i];
  for (int k = 0; k <= depth; ++k) sum += H_[begin_[i] + k] * x[above[k]];
  for (int j = i + 1, last = last_descendant(i); j <= last; ++j)
    sum += H_[begin_[j] + depth] * x[j];
  return sum;
}

}  // namespace retarget
