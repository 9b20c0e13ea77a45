#include "solve/ik/box_qp.h"

#include <Eigen/Cholesky>
#include <limits>
#include <vector>

#include "solve/ik/active_set.h"

namespace retarget {

// A dense System of ActiveSet.
class DenseSystem {
 public:
  explicit DenseSystem(int size) : factor_(size, size), right_(size) { free_.reserve(size); }

  void set(const Eigen::MatrixXd& H, const Eigen::VectorXd& g) {
    H_ = &H;
    g_ = &g;
  }

  bool minimise(const std::vector<BoundSide>& sides, const Eigen::VectorXd& x,
                Eigen::VectorXd& minimum);
  double gradient(int i, const Eigen::VectorXd& x) const {
    // H stores only its lower triangle.
    const Eigen::Index rest = x.size() - i - 1;
    return (*g_)[i] +
           (H_->row(i).head(i + 1).dot(x.head(i + 1)) + H_->col(i).tail(rest).dot(x.tail(rest)));
  }
  double gradient_scale() const { return g_->cwiseAbs().maxCoeff(); }

 private:
  const Eigen::MatrixXd* H_ = nullptr;
  const Eigen::VectorXd* g_ = nullptr;
  std::vector<int> free_;
  Eigen::MatrixXd factor_;  // Cholesky factor of the free block, in the top left corner.
  Eigen::VectorXd right_;
};

bool DenseSystem::minimise(const std::vector<BoundSide>& sides, const Eigen::VectorXd& x,
                           Eigen::VectorXd& minimum) {
  const auto size = static_cast<int>(x.size());
  free_.clear();
  for (int i = 0; i < size; ++i) {
    if (sides[i] == BoundSide::kFree) free_.push_back(i);
  }
  const auto count = static_cast<int>(free_.size());
  auto block = factor_.topLeftCorner(count, count);
  auto right = right_.head(count);
  const Eigen::MatrixXd& H = *H_;
  for (int a = 0; a < count; ++a) {
    const int i = free_[a];
    for (int b = 0; b <= a; ++b) block(a, b) = H(i, free_[b]);
    double sum = -(*g_)[i];
    for (int j = 0; j < size; ++j) {
      if (sides[j] != BoundSide::kFree) sum -= (i > j ? H(i, j) : H(j, i)) * x[j];
    }
    right[a] = sum;
  }
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Lower> cholesky(block);
  if (cholesky.info() != Eigen::Success) return false;
  cholesky.solveInPlace(right);
  for (int a = 0; a < count; ++a) minimum[free_[a]] = right[a];
  return right.allFinite();
}

class BoxQp::Workspace {
 public:
  explicit Workspace(int size) : active_set(size), system(size) {}
  ActiveSet active_set;
  DenseSystem system;
};

BoxQp::BoxQp(int size) : workspace_(std::make_unique<Workspace>(size)) {}

BoxQp::~BoxQp() = default;

namespace {

bool is_finite(const Eigen::MatrixXd& H, const Eigen::VectorXd& g) {
  bool finite = g.allFinite();
  // H stores only its lower triangle.
  for (Eigen::Index i = 0; i < H.rows(); ++i) finite = finite && H.row(i).head(i + 1).allFinite();
  return finite;
}

}  // namespace

BoxQpStats BoxQp::solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                        const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                        Eigen::VectorXd& x) {
  if (!is_finite(H, g)) {
    x = lower.cwiseMax(upper.cwiseMin(Eigen::VectorXd::Zero(x.size())));
    return {0, false};
  }
  workspace_->system.set(H, g);
  workspace_->active_set.resize(static_cast<int>(x.size()));
  workspace_->active_set.reset();
  const auto outcome = workspace_->active_set.solve(workspace_->system, lower, upper, x);
  return {outcome.factorizations, outcome.converged};
}

DenseLeastSquares::DenseLeastSquares(int size)
    : hessian(Eigen::MatrixXd::Zero(size, size)),
      gradient(Eigen::VectorXd::Zero(size)),
      lower(Eigen::VectorXd::Zero(size)),
      upper(Eigen::VectorXd::Zero(size)),
      unit(Eigen::VectorXd::Ones(size)),
      step(Eigen::VectorXd::Zero(size)),
      damped_(hessian),
      qp_(size) {}

std::optional<double> DenseLeastSquares::solve(double damping) {
  damped_ = hessian;
  damped_.diagonal().array() += damping / unit.array().square();
  const BoxQpStats stats = qp_.solve(damped_, gradient, lower, upper, step);
  // BoxQp factorises nothing if a value is not finite.
  if (stats.factorizations == 0) return std::numeric_limits<double>::quiet_NaN();
  return step.norm();
}

}  // namespace retarget
