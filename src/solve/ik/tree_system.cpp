#include "solve/ik/tree_system.h"

#include <algorithm>

#include "base/math/simd.h"

namespace retarget {
namespace {

constexpr int kLanes = 4;

int rounded_up(int count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

// Subtracts whole vectors of one row from another. This also writes the padding behind the end of
// the other row, which nothing reads.
RETARGET_INLINE void subtract_scaled(const double* __restrict row, double scale, int count,
                                     double* __restrict other_row) {
  for (int first = 0; first < count; first += kLanes) {
    for (int i = first; i < first + kLanes; ++i) other_row[i] -= scale * row[i];
  }
}

// The rows of the factors, by variable.
struct Rows {
  double* values;
  const int* begin;           // Start of each row in `values`.
  const int* carriers_begin;  // Start of each row in `carriers`; determines the length of the row.
  const int* carriers;        // Column indices.
  const char* masked;
};

// Factorises H = L'DL in place, the last variable first.
RETARGET_INLINE bool factorise_plain(Rows rows, int size, double* inverse_d) {
  for (int k = size - 1; k >= 0; --k) {
    double* const row = rows.values + rows.begin[k];
    const int depth = rows.carriers_begin[k + 1] - rows.carriers_begin[k] - 1;
    const int* const above = rows.carriers + rows.carriers_begin[k];
    if (!(row[depth] > 0.0)) return false;
    const double inverse = 1.0 / row[depth];
    inverse_d[k] = inverse;
    if (rows.masked[k] != 0) continue;
    for (int m = depth - 1; m >= 0; --m) {
      subtract_scaled(row, row[m] * inverse, m + 1, rows.values + rows.begin[above[m]]);
    }
    // A separate loop, because the vector loads of the loop above would have to wait for single
    // stores.
    for (int m = 0; m < depth; ++m) row[m] *= inverse;
  }
  return true;
}
RETARGET_AVX2(factorise)

}  // namespace

TreeSystem::TreeSystem(const KinematicTree& tree)
    : tree_(tree),
      begin_(tree.row_begin()),
      H_(begin_.back(), 0.0),
      inverse_d_(tree.dof_count(), 0.0),
      masked_(tree.dof_count(), 0),
      g_(Eigen::VectorXd::Zero(tree.dof_count())) {
  int end = 0;
  for (int i = 0; i < size(); ++i) {
    l_begin_.push_back(end);
    end += rounded_up(depth(i) + 1);
  }
  L_.resize(end);
}

// Copies H to the rows of the factors. Clears the padding, whose values could otherwise grow
// without bounds over several factorisations.
void TreeSystem::take_rows() {
  std::ranges::fill(L_, 0.0);
  for (int i = 0; i < size(); ++i) {
    std::copy(H_.begin() + begin_[i], H_.begin() + begin_[i + 1], row_of_l(i));
  }
}

void TreeSystem::add_to_diagonal(double value) {
  for (int i = 0; i < size(); ++i) H_[begin_[i + 1] - 1] += value;
}

int TreeSystem::last_descendant(int i) const {
  const int link = std::max(i - KinematicTree::dof_of(0), 0);
  return KinematicTree::dof_of(tree_.links()[link].last_descendant);
}

bool TreeSystem::minimise(const std::vector<BoundSide>& sides, const Eigen::VectorXd& x,
                          Eigen::VectorXd& minimum) {
  take_rows();
  minimum = -g_;
  for (int i = 0; i < size(); ++i) {
    masked_[i] = sides[i] != BoundSide::kFree ? 1 : 0;
    if (masked_[i] != 0) mask(i, x[i], minimum);
  }
  const Rows rows{L_.data(), l_begin_.data(), begin_.data(), carriers(0), masked_.data()};
  if (!factorise(has_avx2(), rows, size(), inverse_d_.data())) return false;
  solve(minimum);
  return minimum.allFinite();
}

// Removes a variable with the fixed value `value` from the system and moves its terms to the
// right-hand side.
void TreeSystem::mask(int i, double value, Eigen::VectorXd& right) {
  double* const row = row_of_l(i);
  const int depth = this->depth(i);
  const int* const above = carriers(i);
  for (int k = 0; k < depth; ++k) {
    right[above[k]] -= H_[begin_[i] + k] * value;
    row[k] = 0.0;
  }
  row[depth] = 1.0;
  for (int j = i + 1, last = last_descendant(i); j <= last; ++j) {
    right[j] -= H_[begin_[j] + depth] * value;
    row_of_l(j)[depth] = 0.0;
  }
  right[i] = value;
}

// Solves x = H^-1 x with the L'DL factors.
void TreeSystem::solve(Eigen::VectorXd& x) const {
  for (int k = size() - 1; k >= 0; --k) {
    if (masked_[k] != 0) continue;
    const double* const row = row_of_l(k);
    const int depth = this->depth(k);
    const int* const above = carriers(k);
    const double value = x[k];
    for (int m = 0; m < depth; ++m) x[above[m]] -= row[m] * value;
  }
  for (int k = 0; k < size(); ++k) {
    if (masked_[k] != 0) continue;
    const double* const row = row_of_l(k);
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
