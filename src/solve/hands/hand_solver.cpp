#include "solve/hands/hand_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "retarget/trigonometry.h"

namespace retarget {

void HandPosture::set_joint(std::size_t index, double position) {
  const HandJoint& joint = hand_.joints[index];
  const double by = position - joint.reference;
  Pose moved;
  if (joint.slides) {
    moved.translation.z() = by;
  } else {
    const auto [sine, cosine] = portable::sin_cos(0.5 * by);
    moved.rotation = Eigen::Quaterniond(cosine, 0.0, 0.0, sine);
  }
  const Pose local = joint.parent_from_joint * moved;
  palm_from_joint_[index] = joint.parent < 0 ? local : palm_from_joint(joint.parent) * local;
}

Eigen::Vector3d HandPosture::point(const RobotFinger& finger, int k, int& joint) const {
  if (k == static_cast<int>(finger.corners.size())) {
    joint = finger.joints.back();
    return tip(finger);
  }
  joint = finger.corners[static_cast<std::size_t>(k)];
  return palm_from_joint(joint).translation;
}

double HandPosture::gap(const RobotFinger& finger) const {
  const RobotFinger& thumb = *hand_.find(Finger::kThumb);
  return (tip(thumb) - tip(finger)).norm() - thumb.tip_radius - finger.tip_radius;
}

void HandPosture::directions(const RobotFinger& finger, HandTarget::Parts& parts) const {
  parts.count = std::min(static_cast<int>(finger.corners.size()), HandTarget::Parts::kMaxParts);
  for (int k = 0; k < parts.count; ++k) {
    int joint = 0;
    const Eigen::Vector3d from = point(finger, k, joint), to = point(finger, k + 1, joint);
    parts.directions[static_cast<std::size_t>(k)] =
        hand_.palm_axes.transpose() * (to - from).normalized();
  }
}

namespace {

constexpr double kUsualRange = 1.6;  // Range assumed for joints without limits, rad.
constexpr double kMaxStep = 0.7;     // Largest step, as a share of the range.
constexpr int kStepsPerFrame = 12;
constexpr int kStepsOfSearch = 60;
// Weights of the residuals. They enter the cost squared.
constexpr double kDirectionWeight = 1.0;  // Direction errors (of unit vectors) of a whole finger.
// The same of the thumb. Lower, because a robot's thumb has another position in the palm than a
// human's.
constexpr double kThumbDirectionWeight = 0.35;
constexpr double kGapWeight = 0.4;     // Gaps of fingers far from the thumb, per finger length.
constexpr double kTouchWeight = 8.0;   // Gaps of fingers that touch the thumb, per finger length.
constexpr double kRestWeight = 0.07;   // Distance to the relaxed hand, per joint range.
constexpr double kStillWeight = 0.15;  // Distance to the previous frame, per joint range.

std::size_t slot(int index) {
  return static_cast<std::size_t>(index);
}

}  // namespace

HandSolver::HandSolver(const RobotHand& hand, Eigen::VectorXd lower, Eigen::VectorXd upper)
    : hand_(hand),
      match_(hand),
      lower_(std::move(lower)),
      upper_(std::move(upper)),
      posture_(hand),
      system_(static_cast<int>(lower_.size())) {
  const Eigen::Index count = lower_.size();
  range_ = upper_ - lower_;
  open_ = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!(range_[i] > 0.0) || !std::isfinite(range_[i])) range_[i] = kUsualRange;
    open_[i] = std::clamp(0.0, lower_[i], upper_[i]);
  }
  jacobian_.resize(3, count);
  for (Eigen::VectorXd* vector : {&current_, &previous_, &tried_, &best_, &tried_gradient_}) {
    vector->setZero(count);
  }
  tried_matrix_.setZero(count, count);
  system_.unit = range_;
  relaxed_ = open_;
  HandTarget target;
  match_.target(relaxed_hand(), target);
  Eigen::VectorXd found(count);
  search(target, found);
  relaxed_ = found;
}

// Adds the Jacobian of a point that a joint carries, in palm coordinates, times `sign`.
void HandSolver::add_jacobian(int joint, const Eigen::Vector3d& point, double sign) {
  for (int j = joint; j >= 0; j = hand_.joints[slot(j)].parent) {
    const HandJoint& moved = hand_.joints[slot(j)];
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
    const double weight = (is_thumb ? kThumbDirectionWeight : kDirectionWeight) *
                          std::sqrt(shares[slot(k + 1)] - shares[slot(k)]);
    const Eigen::Vector3d way = (to - from) / length;
    const Eigen::Vector3d residual = way - hand_.palm_axes * parts.directions[slot(k)];
    jacobian_.setZero();
    add_jacobian(to_joint, to, 1.0 / length);
    add_jacobian(from_joint, from, -1.0 / length);
    // The derivative of a unit vector is perpendicular to it.
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
  constexpr double kSmall = 1e-4;  // Metres; defines the direction if the tips coincide.
  const auto f = static_cast<std::size_t>(finger.finger);
  const RobotFinger& thumb = *hand_.find(Finger::kThumb);
  const Eigen::Vector3d a = posture_.tip(thumb), b = posture_.tip(finger);
  const double distance = std::sqrt((b - a).squaredNorm() + kSmall * kSmall);
  const double wanted = target.gap[f] + finger.tip_radius + thumb.tip_radius;
  const double weight =
      (kGapWeight + (kTouchWeight - kGapWeight) * target.touch[f]) / finger.length;
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
  pull(relaxed_, kRestWeight);
  if (previous != nullptr) pull(*previous, kStillWeight);
  for (std::size_t i = 0; i < hand_.fingers.size(); ++i) {
    const RobotFinger& finger = hand_.fingers[i];
    // The jaws of a gripper follow only the gap.
    if (!hand_.is_gripper) cost += add_directions(target, i, gradient, matrix);
    if (!target.has_gap[static_cast<std::size_t>(finger.finger)]) continue;
    cost += add_gap(target, finger, gradient, matrix);
  }
  return cost;
}

// The least-squares problem of a frame, for damped_least_squares(). Each trial also computes
// gradient and Hessian.
struct HandSolver::Descent {
  HandSolver& hand;
  const HandTarget& target;
  const Eigen::VectorXd* previous;
  Eigen::VectorXd& variables;

  double cost() {
    return hand.evaluate(target, variables, previous, hand.system_.gradient, hand.system_.hessian);
  }
  void linearise() {}
  std::optional<double> solve(double damping) {
    DenseLeastSquares& system = hand.system_;
    system.lower = (hand.lower_ - variables).cwiseMax(-kMaxStep * hand.range_);
    system.upper = (hand.upper_ - variables).cwiseMin(kMaxStep * hand.range_);
    return system.solve(damping);
  }
  double try_step(double length) {
    hand.tried_ =
        (variables + length * hand.system_.step).cwiseMax(hand.lower_).cwiseMin(hand.upper_);
    return hand.evaluate(target, hand.tried_, previous, hand.tried_gradient_, hand.tried_matrix_);
  }
  void accept() {
    variables.swap(hand.tried_);
    hand.system_.gradient.swap(hand.tried_gradient_);
    hand.system_.hessian.swap(hand.tried_matrix_);
  }
  void reject() {}
};

double HandSolver::descend(const HandTarget& target, const Eigen::VectorXd* previous, int steps,
                           Eigen::VectorXd& variables) {
  const LeastSquaresPolicy policy{.max_steps = steps,
                                  .initial_damping = 1e-4,
                                  .max_damping = 1e4,
                                  .relative_change = 1e-7,
                                  .absolute_change = 1e-14};
  Descent problem{*this, target, previous, variables};
  const LeastSquaresResult result = damped_least_squares(problem, policy);
  return result.status == LeastSquaresStatus::kNonFinite ? NAN : result.cost;
}

double HandSolver::search(const HandTarget& target, Eigen::VectorXd& variables) {
  // Shares of the way from the open to the closed hand. A joint closes towards the end of its range
  // that is farther from its open position.
  constexpr std::array kStarts = {0.0, 0.25, 0.5, 0.8};
  double least = HUGE_VAL;
  const auto try_start = [&] {
    const double cost = descend(target, nullptr, kStepsOfSearch, current_);
    if (!(cost < least)) return;
    least = cost;
    best_ = current_;
  };
  current_ = best_ = relaxed_;
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
  return least;
}

const Eigen::VectorXd& HandSolver::solve(const HandTarget& target) {
  if (!has_previous_) {
    failed_ = !std::isfinite(search(target, previous_));
    current_ = previous_;
    has_previous_ = !failed_;
    return current_;
  }
  current_ = previous_;
  failed_ = !std::isfinite(descend(target, &previous_, kStepsPerFrame, current_));
  previous_ = current_;
  return current_;
}

}  // namespace retarget
