#include "dynamics/force_cone.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace retarget {
namespace {

// added to the squares of the amounts: keeps the problem strictly convex
constexpr double kRidge = 1e-6;

}  // namespace

void ForceCone::add_point(const Eigen::Vector3d& lever, double friction) {
  if (count_ == kMaxEdges) return;
  for (int i = 0; i < kEdges; ++i) {
    const double sign = i % 2 == 0 ? friction : -friction;
    const Eigen::Vector3d force(i < 2 ? sign : 0.0, i < 2 ? 0.0 : sign, 1.0);
    edges_.col(count_++) << force, lever.cross(force);
  }
}

// the normal equations on the edges that bear
class ConeProjector::System {
 public:
  explicit System(ConeProjector& projector) : projector_(projector) {}

  bool minimise(const std::vector<BoundSide>& sides, const Eigen::VectorXd& /*x*/,
                Eigen::VectorXd& minimum) {
    return projector_.minimise(sides, minimum);
  }
  double gradient(int i, const Eigen::VectorXd& x) { return projector_.gradient(i, x); }
  [[nodiscard]] double gradient_scale() const {
    constexpr double kSmall =
        1e4;  // of the multipliers' tolerance: an edge longer than 1e-10 counts
    return kSmall * std::max(1.0, projector_.wrench_.norm());
  }

 private:
  ConeProjector& projector_;
};

ConeProjector::ConeProjector()
    : active_(ForceCone::kMaxEdges),
      wrench_(Vector6d::Zero()),
      rest_(wrench_),
      lower_(Eigen::VectorXd::Zero(ForceCone::kMaxEdges)),
      upper_(
          Eigen::VectorXd::Constant(ForceCone::kMaxEdges, std::numeric_limits<double>::infinity())),
      amounts_(lower_) {
  bearing_.reserve(ForceCone::kMaxEdges);
}

bool ConeProjector::minimise(const std::vector<BoundSide>& sides, Eigen::VectorXd& minimum) {
  rest_is_known_ = false;
  bearing_.clear();
  for (int i = 0; i < cone_->count_; ++i) {
    if (sides[static_cast<std::size_t>(i)] == BoundSide::kFree) bearing_.push_back(i);
  }
  const auto size = static_cast<int>(bearing_.size());
  if (size == 0) return true;
  Gram gram(size, size);
  Amounts right(size);
  for (int a = 0; a < size; ++a) {
    const auto edge = cone_->edges_.col(bearing_[static_cast<std::size_t>(a)]);
    for (int b = 0; b <= a; ++b) {
      gram(a, b) = edge.dot(cone_->edges_.col(bearing_[static_cast<std::size_t>(b)]));
    }
    gram(a, a) += kRidge;
    right[a] = edge.dot(wrench_);
  }
  const Eigen::LLT<Gram> factor(gram);
  if (factor.info() != Eigen::Success) return false;
  factor.solveInPlace(right);
  for (int a = 0; a < size; ++a) minimum[bearing_[static_cast<std::size_t>(a)]] = right[a];
  return true;
}

double ConeProjector::gradient(int i, const Eigen::VectorXd& x) {
  if (i >= cone_->count_) return 0.0;
  if (!rest_is_known_) {
    rest_ = wrench_;
    for (const int edge : bearing_) rest_ -= x[edge] * cone_->edges_.col(edge);
    rest_is_known_ = true;
  }
  return kRidge * x[i] - cone_->edges_.col(i).dot(rest_);
}

Vector6d ConeProjector::project(ForceCone& cone, const Vector6d& wrench) {
  cone_ = &cone;
  wrench_ = wrench;
  rest_is_known_ = false;
  bearing_.clear();
  if (cone.empty()) return wrench;
  active_.begin_with(cone.sides_);
  System system(*this);
  active_.solve(system, lower_, upper_, amounts_);
  std::ranges::copy(active_.sides(), cone.sides_.begin());
  bearing_.clear();
  rest_ = wrench;
  for (int i = 0; i < cone.count_; ++i) {
    if (cone.sides_[static_cast<std::size_t>(i)] != BoundSide::kFree) continue;
    bearing_.push_back(i);
    rest_ -= amounts_[i] * cone.edges_.col(i);
  }
  return rest_;
}

Matrix6d ConeProjector::complement() const {
  Matrix6d complement = Matrix6d::Identity();
  const auto size = static_cast<int>(bearing_.size());
  if (size == 0) return complement;
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, ForceCone::kMaxEdges> edges(6, size);
  for (int a = 0; a < size; ++a) {
    edges.col(a) = cone_->edges_.col(bearing_[static_cast<std::size_t>(a)]);
  }
  Gram gram = edges.transpose() * edges;
  gram.diagonal().array() += kRidge;
  complement -= edges * gram.llt().solve(edges.transpose());
  return complement;
}

}  // namespace retarget
