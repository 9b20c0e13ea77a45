#include "solve/dynamics/force_cone.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace retarget {
namespace {

// Weight of the squared amounts. It makes the problem strictly convex.
constexpr double kRidge = 1e-6;

}  // namespace

Eigen::Matrix<double, 3, 4> friction_pyramid(double friction, const Eigen::Vector3d& normal,
                                             const Eigen::Vector3d& forward) {
  // For a horizontal surface, the tangents are `forward` and the direction to its left.
  constexpr double kSteep = 0.9;
  const Eigen::Vector3d aside = std::abs(normal.dot(forward)) < kSteep
                                    ? forward
                                    : Eigen::Vector3d(Eigen::Vector3d::UnitZ().cross(forward));
  const Eigen::Vector3d first = (aside - normal.dot(aside) * normal).normalized();
  const Eigen::Vector3d second = normal.cross(first);
  Eigen::Matrix<double, 3, 4> edges;
  edges << friction * first, -friction * first, friction * second, -friction * second;
  edges.colwise() += normal;
  return edges;
}

void ForceCone::add_point(const Eigen::Vector3d& lever, double friction,
                          const Eigen::Vector3d& normal, const Eigen::Vector3d& forward) {
  if (count_ == kMaxEdges) return;
  const Eigen::Matrix<double, 3, kEdges> pyramid = friction_pyramid(friction, normal, forward);
  for (int i = 0; i < kEdges; ++i) {
    const Eigen::Vector3d force = pyramid.col(i);
    edges_.col(count_++) << force, lever.cross(force);
  }
}

// The normal equations of the edges with a non-zero amount (bearing edges).
class ConeProjector::System {
 public:
  explicit System(ConeProjector& projector) : projector_(projector) {}

  bool minimise(const std::vector<BoundSide>& sides, const Eigen::VectorXd& /*x*/,
                Eigen::VectorXd& minimum) {
    return projector_.minimise(sides, minimum);
  }
  double gradient(int i, const Eigen::VectorXd& x) { return projector_.gradient(i, x); }
  [[nodiscard]] double gradient_scale() const {
    // With the multipliers' tolerance of 1e-14, an edge that would reduce the residual by less than
    // 1e-5 of the wrench stays unused. Otherwise the ridge would spread each force over all edges.
    constexpr double kSmall = 1e9;
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
  if (bearing_.empty()) return true;
  if (!factorise()) return false;
  // Forward substitution, then back substitution.
  const std::size_t size = bearing_.size();
  for (std::size_t a = 0; a < size; ++a) {
    const double* const row = factor_.data() + a * ForceCone::kMaxEdges;
    double sum = cone_->edges_.col(bearing_[a]).dot(wrench_);
    for (std::size_t b = 0; b < a; ++b) sum -= row[b] * right_[b];
    right_[a] = sum / row[a];
  }
  for (std::size_t a = size; a-- > 0;) {
    double sum = right_[a];
    for (std::size_t b = a + 1; b < size; ++b) {
      sum -= factor_[b * ForceCone::kMaxEdges + a] * right_[b];
    }
    right_[a] = sum / factor_[a * ForceCone::kMaxEdges + a];
    if (!std::isfinite(right_[a])) return false;
    minimum[bearing_[a]] = right_[a];
  }
  return true;
}

// Cholesky factorisation of the Gram matrix of the bearing edges. There are usually two to six.
bool ConeProjector::factorise() {
  for (std::size_t a = 0; a < bearing_.size(); ++a) {
    double* const row = factor_.data() + a * ForceCone::kMaxEdges;
    const Vector6d edge = cone_->edges_.col(bearing_[a]);
    for (std::size_t b = 0; b <= a; ++b) {
      const double* const other = factor_.data() + b * ForceCone::kMaxEdges;
      double sum = edge.dot(cone_->edges_.col(bearing_[b]));
      for (std::size_t k = 0; k < b; ++k) sum -= row[k] * other[k];
      if (a != b) {
        row[b] = sum / other[b];
        continue;
      }
      sum += kRidge;
      if (!(sum > 0.0)) return false;
      row[a] = std::sqrt(sum);
    }
  }
  return true;
}

double ConeProjector::gradient(int i, const Eigen::VectorXd& x) {
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
  const auto count = static_cast<std::size_t>(cone.count_);
  active_.resize(cone.count_);
  active_.begin_with(std::span(cone.sides_).first(count));
  System system(*this);
  active_.solve(system, lower_, upper_, amounts_);
  std::ranges::copy(std::span(active_.sides()).first(count), cone.sides_.begin());
  bearing_.clear();
  rest_ = wrench;
  for (int i = 0; i < cone.count_; ++i) {
    if (cone.sides_[static_cast<std::size_t>(i)] != BoundSide::kFree) continue;
    bearing_.push_back(i);
    rest_ -= amounts_[i] * cone.edges_.col(i);
    cone.amounts_[static_cast<std::size_t>(i)] = amounts_[i];
  }
  return rest_;
}

bool ConeProjector::explains(const ForceCone& cone, const Vector6d& wrench, double rest) {
  Vector6d left = wrench;
  for (int i = 0; i < cone.count_; ++i) {
    if (cone.sides_[static_cast<std::size_t>(i)] != BoundSide::kFree) continue;
    left -= cone.amounts_[static_cast<std::size_t>(i)] * cone.edges_.col(i);
  }
  return left.squaredNorm() <= rest * rest;
}

Matrix6d ConeProjector::complement() {
  Matrix6d complement = Matrix6d::Identity();
  // With the Cholesky factor L: 1 - E (L L')^-1 E' = 1 - sum of r r' over the rows r of L^-1 E'.
  if (bearing_.empty() || !factorise()) return complement;
  for (std::size_t a = 0; a < bearing_.size(); ++a) {
    const double* const row = factor_.data() + a * ForceCone::kMaxEdges;
    Vector6d& reduced = reduced_[a];
    reduced = cone_->edges_.col(bearing_[a]);
    for (std::size_t b = 0; b < a; ++b) reduced -= row[b] * reduced_[b];
    reduced /= row[a];
    complement.noalias() -= reduced * reduced.transpose();
  }
  return complement;
}

}  // namespace retarget
