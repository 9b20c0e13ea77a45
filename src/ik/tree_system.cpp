#include "ik/tree_system.h"

#include <cmath>

namespace retarget {
namespace {

// rows do not overlap, which the compiler cannot know: asking it each time costs more than the sum
void subtract_scaled(const double* __restrict row, double scale, int count,
                     double* __restrict other_row) {
  for (int i = 0; i < count; ++i) other_row[i] -= scale * row[i];
}

}  // namespace

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
  masked_.assign(size, 0);
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
    if (masked_[k] != 0) continue;
    for (int m = depth - 1; m >= 0; --m) {
      const double scaled = row[m] * inverse;
      subtract_scaled(row, scaled, m + 1, L_.data() + begin_[carriers(k)[m]]);
      row[m] = scaled;
    }
  }
  return true;
}

// x = H^-1 x by L'DL
void TreeSystem::solve(Eigen::VectorXd& x) const {
  for (int k = size() - 1; k >= 0; --k) {
    if (masked_[k] != 0) continue;
    const double* const row = L_.data() + begin_[k];
    const int depth = row_size(k) - 1;
    const double value = x[k];
    for (int m = 0; m < depth; ++m) x[carriers(k)[m]] -= row[m] * value;
  }
  for (int k = 0; k < size(); ++k) {
    if (masked_[k] != 0) continue;
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
