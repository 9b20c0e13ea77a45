#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "ik/active_set.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// A symmetric system with the sparsity of a kinematic tree: entry (i, j) is not zero only where
/// one of the two joints carries the other. Serves ActiveSet.
///
/// Rows are KinematicTree's. As the carriers of a carrier come first in that order, row j is laid
/// out like the head of every row below it, and the factorisation H = L'DL (Featherstone, "Rigid
/// Body Dynamics Algorithms", section 6.5 and table 6.3) is a chain of updates of contiguous
/// numbers that keeps the sparsity. A bound variable is masked: its row and column count as zero,
/// its diagonal as one, which keeps it too.
class TreeSystem {
 public:
  /// The tree must stay where it is.
  explicit TreeSystem(const KinematicTree& tree);

  [[nodiscard]] int size() const { return tree_.dof_count(); }
  /// Rows over the tree's carriers, one after the other, the diagonal last in each.
  [[nodiscard]] std::span<double> hessian() { return H_; }
  [[nodiscard]] Eigen::VectorXd& linear() { return g_; }
  void add_to_diagonal(double value);

  /// For ActiveSet; sides of variables that are bound are not free.
  bool minimise(const std::vector<BoundSide>& sides, const Eigen::VectorXd& x,
                Eigen::VectorXd& minimum);
  [[nodiscard]] double gradient(int i, const Eigen::VectorXd& x) const;
  [[nodiscard]] double gradient_scale() const { return g_.cwiseAbs().maxCoeff(); }

 private:
  void mask(int i, double value, Eigen::VectorXd& right);
  bool factorise();
  void solve(Eigen::VectorXd& x) const;
  [[nodiscard]] int last_descendant(int i) const;
  /// What carries variable i: how many there are, and their rows' columns.
  [[nodiscard]] int depth(int i) const { return begin_[i + 1] - begin_[i] - 1; }
  [[nodiscard]] const int* carriers(int i) const { return tree_.carriers(i).data(); }

  const KinematicTree& tree_;
  const std::vector<int>& begin_;  // where each row starts; one more at the end
  std::vector<double> H_, L_;      // rows as described; L_ holds D on the diagonal
  std::vector<double> inverse_d_;
  std::vector<char> masked_;  // rows of bound variables: zeros and a one
  Eigen::VectorXd g_;
};

}  // namespace retarget
