#pragma once

#include <Eigen/Core>
#include <vector>

#include "ik/active_set.h"
#include "ik/moving_tree.h"

namespace retarget {

/// A symmetric system with the sparsity of a kinematic tree: entry (i, j) is not zero only where
/// one of the two joints carries the other. Serves ActiveSet.
///
/// Row i holds the entries with the degrees of freedom that carry i, from the root down to i
/// itself, next to each other. As the carriers of a carrier come first in that order, row j is laid
/// out like the head of every row below it, and the factorisation H = L'DL (Featherstone, "Rigid
/// Body Dynamics Algorithms", section 6.5 and table 6.3) is a chain of updates of contiguous
/// numbers that keeps the sparsity. A bound variable is masked: its row and column count as zero,
/// its diagonal as one, which keeps it too.
class TreeSystem {
 public:
  explicit TreeSystem(const MovingTree& tree);

  [[nodiscard]] int size() const { return static_cast<int>(begin_.size()) - 1; }
  /// Entries of row i, the diagonal last.
  [[nodiscard]] double* row(int i) { return H_.data() + begin_[i]; }
  [[nodiscard]] int row_size(int i) const { return begin_[i + 1] - begin_[i]; }
  [[nodiscard]] Eigen::VectorXd& linear() { return g_; }

  /// For ActiveSet; sides of variables that are bound are not free.
  bool minimise(const std::vector<BoundSide>& sides, const Eigen::VectorXd& x,
                Eigen::VectorXd& minimum);
  [[nodiscard]] double gradient(int i, const Eigen::VectorXd& x) const;
  [[nodiscard]] double gradient_scale() const { return g_.cwiseAbs().maxCoeff(); }

 private:
  void mask(int i, double value, Eigen::VectorXd& right);
  bool factorise();
  void solve(Eigen::VectorXd& x) const;
  [[nodiscard]] const int* carriers(int i) const { return carriers_.data() + begin_[i]; }

  std::vector<int> begin_;            // where each row starts; one more at the end
  std::vector<int> carriers_;         // column of each entry
  std::vector<int> last_descendant_;  // of each variable
  std::vector<double> H_, L_;         // rows as described; L_ holds D on the diagonal
  std::vector<double> inverse_d_;
  std::vector<char> masked_;  // rows of bound variables: zeros and a one
  Eigen::VectorXd g_;
};

}  // namespace retarget
