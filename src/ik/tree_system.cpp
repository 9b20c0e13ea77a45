#include "ik/tree_system.h"

#include <cmath>

namespace retarget {

TreeSystem::TreeSystem(const MovingTree& tree) : g_(Eigen::VectorXd::Zero(tree.dof_count())) {
  constexpr int kBase = MovingTree::kBaseDofs;
  const int size = tree.dof_count();
  begin_.push_back(0);
  for (int i = 0; i < size; ++i) {
    // the base carries everything; a node is carried by what carries its parent, and the parent
    const int parent = i < kBase ? i - 1
                       : tree.nodes()[i - kBase].parent == MovingTree::kBase
                           ? kBase - 1
                           : tree.nodes()[i - kBase].parent + kBase;
    if (parent >= 0) {
      for (int k = begin_[parent]; k < begin_[parent + 1]; ++k) {
        const int carrier = carriers_[k];
        carriers_.push_back(carrier);
      }
    }
    carriers_.push_back(i);
    begin_.push_back(static_cast<int>(carriers_.size()));
    last_descendant_.push_back(i < kBase ? size - 1
                                         : tree.nodes()[i - kBase].last_descendant + kBase);
  }
  H_.assign(carriers_.size(), 0.0);
  L_.assign(carriers_.size(), 0.0);
  inverse_d_.assign(size, 0.0);
}

bool TreeSystem::minimise(const std::vector<BoundSide>& sides, const Eigen::VectorXd& x,
                          Eigen::VectorXd& minimum) {
  L_ = H_;
  minimum = -g_;
  for (int i = 0; i < size(); ++i) {
    if (sides[i] != BoundSide::kFree) mask(i, x[i], minimum);
  }
  if (!factorise()) return false;
  solve(minimum);
  return minimum.allFinite();
}

// takes a variable that is held at `value` out of the system and its effect to the right side
void TreeSystem::mask(int i, double value, Eigen::VectorXd& right) {
  double* const row = L_.data() + begin_[i];
  const int depth = row_size(i) - 1;
  for (int k = 0; k < depth; ++k) {
    right[carriers(i)[k]] -= H_[begin_[i] + k] * value;
    row[k] = 0.0;
  }
  row[depth] = 1.0;
  for (int j = i + 1; j <= last_descendant_[i]; ++j) {
    right[j] -= H_[begin_[j] + depth] * value;
    L_[begin_[j] + depth] = 0.0;
  }
  right[i] = value;
}

// H = L'DL in place, the last variable first
bool TreeSystem::factorise() {
  for (int k = size() - 1; k >= 0; --k) {
    double* const row = L_.data() + begin_[k];
    const int depth = row_size(k) - 1;
    if (!(row[depth] > 0.0)) return false;
    const double inverse = 1.0 / row[depth];
    inverse_d_[k] = inverse;
    for (int m = depth - 1; m >= 0; --m) {
      const double scaled = row[m] * inverse;
      double* const carrier_row = L_.data() + begin_[carriers(k)[m]];
      for (int n = 0; n <= m; ++n) carrier_row[n] -= scaled * row[n];
      row[m] = scaled;
    }
  }
  return true;
}

// x = H^-1 x by L'DL
void TreeSystem::solve(Eigen::VectorXd& x) const {
  for (int k = size() - 1; k >= 0; --k) {
    const double* const row = L_.data() + begin_[k];
    const int depth = row_size(k) - 1;
    const double value = x[k];
    for (int m = 0; m < depth; ++m) x[carriers(k)[m]] -= row[m] * value;
  }
  for (int k = 0; k < size(); ++k) {
    const double* const row = L_.data() + begin_[k];
    const int depth = row_size(k) - 1;
    double value = x[k] * inverse_d_[k];
    for (int m = 0; m < depth; ++m) value -= row[m] * x[carriers(k)[m]];
    x[k] = value;
  }
}

double TreeSystem::gradient(int i, const Eigen::VectorXd& x) const {
  const int depth = row_size(i) - 1;
  double sum = g_[i];
  for (int k = 0; k <= depth; ++k) sum += H_[begin_[i] + k] * x[carriers(i)[k]];
  for (int j = i + 1; j <= last_descendant_[i]; ++j) sum += H_[begin_[j] + depth] * x[j];
  return sum;
}

}  // namespace retarget
