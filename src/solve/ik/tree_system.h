#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "solve/ik/active_set.h"

namespace retarget {

/// A symmetric system with the sparsity of a kinematic tree: entry (i, j) can be non-zero only if
/// one of the two joints is an ancestor of the other. A System of ActiveSet.
///
/// Rows are in the order of KinematicTree, with ancestors first. The row of a joint therefore
/// begins like the rows of its ancestors. The factorisation H = L'DL (Featherstone, "Rigid Body
/// Dynamics Algorithms", section 6.5 and table 6.3) is then a sequence of updates of contiguous
/// values and preserves the sparsity. A bound variable is masked: its row and column are zero
/// except for 1 on the diagonal, which also preserves the sparsity.
class TreeSystem {
 public:
  /// @param tree  must outlive the system and stay at its address.
  explicit TreeSystem(const KinematicTree& tree);

  [[nodiscard]] int size() const { return tree_.dof_count(); }
  /// The rows of H, one after the other. A row has the entries of the variable's ancestors, then
  /// the diagonal entry.
  [[nodiscard]] std::span<double> hessian() { return H_; }
  [[nodiscard]] Eigen::VectorXd& linear() { return g_; }
  void add_to_diagonal(double value);

  /// Used by ActiveSet: minimises over the free variables, with the bound variables fixed at x.
  bool minimise(const std::vector<BoundSide>& sides, const Eigen::VectorXd& x,
                Eigen::VectorXd& minimum);
  [[nodiscard]] double gradient(int i, const Eigen::VectorXd& x) const;
  [[nodiscard]] double gradient_scale() const { return g_.cwiseAbs().maxCoeff(); }

 private:
  void mask(int i, double value, Eigen::VectorXd& right);
  void take_rows();
  void solve(Eigen::VectorXd& x) const;
  [[nodiscard]] int last_descendant(int i) const;
  [[nodiscard]] double* row_of_l(int i) { return L_.data() + l_begin_[i]; }
  [[nodiscard]] const double* row_of_l(int i) const { return L_.data() + l_begin_[i]; }
  /// Number of ancestors of variable i, and their column indices.
  [[nodiscard]] int depth(int i) const { return begin_[i + 1] - begin_[i] - 1; }
  [[nodiscard]] const int* carriers(int i) const { return tree_.carriers(i).data(); }

  const KinematicTree& tree_;
  const std::vector<int>& begin_;  // Start of each row, plus the end of the last one.
  std::vector<double> H_;          // Rows as in hessian().
  std::vector<int> l_begin_;       // Offset of each row in L_. Rows are padded to whole vectors.
  std::vector<double> L_;          // Holds D on the diagonal.
  std::vector<double> inverse_d_;
  std::vector<char> masked_;  // One per variable: whether it is bound.
  Eigen::VectorXd g_;
};

}  // namespace retarget
