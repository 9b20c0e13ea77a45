#include "hands/hand_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace retarget {
namespace {

constexpr double kUsualRange = 1.6;  // rad; of joints without one
constexpr double kMaxStep = 0.7;     // of a range, in one step
constexpr int kStepsPerFrame = 12;
constexpr int kStepsOfSearch = 60;

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

}  // namespace

HandSolver::HandSolver(const RobotHand& hand, Eigen::VectorXd lower, Eigen::VectorXd upper,
                       const HandWeights& weights)
    : hand_(hand),
      match_(hand),
      weights_(weights),
      lower_(std::move(lower)),
      upper_(std::move(upper)),
      posture_(hand),
      qp_(static_cast<int>(lower_.size())) {
  const Eigen::Index count = lower_.size();
  range_ = upper_ - lower_;
  open_ = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!(range_[i] > 0.0) || !std::isfinite(range_[i])) range_[i] = kUsualRange;
    open_[i] = std::clamp(0.0, lower_[i], upper_[i]);
  }
  jacobian_.resize(3, count);
  for (Eigen::VectorXd* vector : {&current_, &previous_, &tried_, &best_, &step_, &step_lower_,
                                  &step_upper_, &gradient_, &tried_gradient_}) {
    vector->setZero(count);
  }
  for (Eigen::MatrixXd* matrix : {&matrix_, &tried_matrix_, &damped_}) {
    matrix->setZero(count, count);
  }
  relaxed_ = open_;
  HandTarget target;
  match_.target(relaxed_hand(), target);
  Eigen::VectorXd found(count);
  search(target, found);
  relaxed_ = found;
}

// how a point that a joint carries moves, added to the columns of what moves it
void HandSolver::add_jacobian(int joint, const Eigen::Vector3d& point, double sign) {
  for (int j = joint; j >= 0; j = hand_.joints[at(j)].parent) {
    const HandJoint& moved = hand_.joints[at(j)];
    const Pose& pose = posture_.palm_from_joint(j);
    const Eigen::Vector3d axis = pose.rotation * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d velocity =
        moved.slides ? axis : Eigen::Vector3d(axis.cross(point - pose.translation));
    jacobian_.col(moved.variable) += sign * moved.ratio * velocity;
  }
}

void HandSolver::add_rows(const Eigen::Vector3d& residual, double weight, Eigen::VectorXd& gradient,
                          Eigen::MatrixXd& matrix) {
  const double square = weight * weight;
  for (Eigen::Index a = 0; a < jacobian_.cols(); ++a) {
    if (jacobian_.col(a).isZero(0.0)) continue;
    gradient[a] += square * jacobian_.col(a).dot(residual);
    for (Eigen::Index b = 0; b <= a; ++b) {
      matrix(a, b) += square * jacobian_.col(a).dot(jacobian_.col(b));
    }
  }
}

double HandSolver::add_directions(const HandTarget& target, std::size_t index,
                                  Eigen::VectorXd& gradient, Eigen::MatrixXd& matrix) {
  const RobotFinger& finger = hand_.fingers[index];
  const HandTarget::Parts& parts = target.parts[static_cast<std::size_t>(finger.finger)];
  const std::vector<double>& shares = match_.shares(index);
  const bool is_thumb = finger.finger == Finger::kThumb;
  double cost = 0.0;
  for (int k = 0; k < parts.count; ++k) {
    int from_joint = 0, to_joint = 0;
    const Eigen::Vector3d from = posture_.point(finger, k, from_joint);
    const Eigen::Vector3d to = posture_.point(finger, k + 1, to_joint);
    const double length = (to - from).norm();
    if (!(length > 0.0)) continue;
    const double weight = (is_thumb ? weights_.thumb_direction : weights_.direction) *
                          std::sqrt(shares[at(k + 1)] - shares[at(k)]);
    const Eigen::Vector3d way = (to - from) / length;
    const Eigen::Vector3d residual = way - hand_.palm_axes * parts.directions[at(k)];
    jacobian_.setZero();
    add_jacobian(to_joint, to, 1.0 / length);
    add_jacobian(from_joint, from, -1.0 / length);
    // of a unit vector
    for (Eigen::Index c = 0; c < jacobian_.cols(); ++c) {
      jacobian_.col(c) -= way.dot(jacobian_.col(c)) * way;
    }
    cost += 0.5 * weight * weight * residual.squaredNorm();
    add_rows(residual, weight, gradient, matrix);
  }
  return cost;
}

double HandSolver::add_gap(const HandTarget& target, const RobotFinger& finger,
                           Eigen::VectorXd& gradient, Eigen::MatrixXd& matrix) {
  constexpr double kSmall = 1e-4;  // metres: tips in one place have no direction to each other
  const auto f = static_cast<std::size_t>(finger.finger);
  const RobotFinger& thumb = *hand_.find(Finger::kThumb);
  const Eigen::Vector3d a = posture_.tip(thumb), b = posture_.tip(finger);
  const double distance = std::sqrt((b - a).squaredNorm() + kSmall * kSmall);
  const double wanted = target.gap[f] + finger.tip_radius + thumb.tip_radius;
  const double weight =
      (weights_.gap + (weights_.touch - weights_.gap) * target.touch[f]) / finger.length;
  jacobian_.setZero();
  add_jacobian(finger.joints.back(), b, 1.0);
  add_jacobian(thumb.joints.back(), a, -1.0);
  const Eigen::Vector3d way = (b - a) / distance;
  for (Eigen::Index c = 0; c < jacobian_.cols(); ++c) {
    jacobian_.col(c) = Eigen::Vector3d(way.dot(jacobian_.col(c)), 0.0, 0.0);
  }
  const double residual = distance - wanted;
  add_rows({residual, 0.0, 0.0}, weight, gradient, matrix);
  return 0.5 * weight * weight * residual * residual;
}

double HandSolver::evaluate(const HandTarget& target, const Eigen::VectorXd& variables,
                            const Eigen::VectorXd* previous, Eigen::VectorXd& gradient,
                            Eigen::MatrixXd& matrix) {
  gradient.setZero();
  matrix.setZero();
  posture_.set_variables(variables);
  double cost = 0.0;
  const auto pull = [&](const Eigen::VectorXd& to, double strength) {
    for (Eigen::Index i = 0; i < variables.size(); ++i) {
      const double weight = strength / range_[i];
      const double residual = weight * (variables[i] - to[i]);
      cost += 0.5 * residual * residual;
      gradient[i] += weight * residual;
      matrix(i, i) += weight * weight;
    }
  };
  pull(relaxed_, weights_.rest);
  if (previous != nullptr) pull(*previous, weights_.still);
  for (std::size_t i = 0; i < hand_.fingers.size(); ++i) {
    const RobotFinger& finger = hand_.fingers[i];
    // jaws point nowhere
    if (!hand_.is_gripper) cost += add_directions(target, i, gradient, matrix);
    if (!target.has_gap[static_cast<std::size_t>(finger.finger)]) continue;
    cost += add_gap(target, finger, gradient, matrix);
  }
  return cost;
}

double HandSolver::descend(const HandTarget& target, const Eigen::VectorXd* previous, int steps,
                           Eigen::VectorXd& variables) {
  constexpr double kSettled = 1e-7, kMaxDamping = 1e4;
  double cost = evaluate(target, variables, previous, gradient_, matrix_);
  double damping = 1e-4;
  for (int i = 0; i < steps && damping < kMaxDamping; ++i) {
    damped_ = matrix_;
    for (Eigen::Index k = 0; k < variables.size(); ++k) {
      damped_(k, k) += damping / (range_[k] * range_[k]);
      step_lower_[k] = std::max(lower_[k] - variables[k], -kMaxStep * range_[k]);
      step_upper_[k] = std::min(upper_[k] - variables[k], kMaxStep * range_[k]);
    }
    qp_.solve(damped_, gradient_, step_lower_, step_upper_, step_);
    tried_ = (variables + step_).cwiseMax(lower_).cwiseMin(upper_);
    const double now = evaluate(target, tried_, previous, tried_gradient_, tried_matrix_);
    if (!(now < cost)) {
      damping = std::max(10.0 * damping, 1e-3);
      continue;
    }
    const bool settled = cost - now < kSettled * (cost + kSettled);
    variables.swap(tried_);
    gradient_.swap(tried_gradient_);
    matrix_.swap(tried_matrix_);
    cost = now;
    damping *= 0.1;
    if (settled) break;
  }
  return cost;
}

void HandSolver::search(const HandTarget& target, Eigen::VectorXd& variables) {
  // from open to closed, whichever way a joint closes: to the farther end of its range
  constexpr std::array kStarts = {0.0, 0.25, 0.5, 0.8};
  double least = HUGE_VAL;
  const auto try_start = [&] {
    const double cost = descend(target, nullptr, kStepsOfSearch, current_);
    if (!(cost < least)) return;
    least = cost;
    best_ = current_;
  };
  current_ = relaxed_;
  try_start();
  for (const double share : kStarts) {
    for (Eigen::Index i = 0; i < current_.size(); ++i) {
      const bool up = upper_[i] - open_[i] >= open_[i] - lower_[i];
      const double to = open_[i] + (up ? share : -share) * range_[i];
      current_[i] = std::clamp(to, lower_[i], upper_[i]);
    }
    try_start();
  }
  variables = best_;
}

const Eigen::VectorXd& HandSolver::solve(const HandTarget& target) {
  if (!has_previous_) {
    search(target, previous_);
    current_ = previous_;
    has_previous_ = true;
    return current_;
  }
  current_ = previous_;
  descend(target, &previous_, kStepsPerFrame, current_);
  previous_ = current_;
  return current_;
}

}  // namespace retarget
