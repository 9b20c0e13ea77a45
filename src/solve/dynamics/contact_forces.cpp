#include "solve/dynamics/contact_forces.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>

#include "base/math/least_squares.h"
#include "base/math/se3.h"
#include "solve/dynamics/force_cone.h"

namespace retarget {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kEdges = ForceCone::kEdges;
constexpr int kUnknowns = kEdges * static_cast<int>(ContactForces::kMaxPoints);
// Weight of a force per body weight. It makes the problem strictly convex.
constexpr double kForceWeight = 0.003;
// Share of a limit beyond which a torque has an excess. Below 1, so that a torque that can stay
// within its limit does so despite the other terms.
constexpr double kWithin = 0.98;
// Weight of a change of the wrench by the body weight, relative to an excess as large as the limit.
constexpr double kKeep = 100.0;

}  // namespace

ContactForces::ContactForces(const KinematicTree& tree, std::span<const double> torque_limits,
                             double weight, double lever)
    : tree_(&tree),
      weight_(weight),
      lever_(lever),
      levers_(kMaxPoints),
      edges_(kMaxPoints),
      jacobians_(kMaxPoints, RowsOfJoints::Zero(static_cast<int>(tree.links().size()), 3)),
      scaled_jacobians_(jacobians_),
      scale_(Eigen::VectorXd::Zero(static_cast<int>(tree.links().size()))),
      scaled_torques_(scale_),
      qp_(kUnknowns),
      unloaded_(scale_),
      joint_torques_(tree.links().size(), 0.0) {
  forces_.reserve(kMaxPoints);
  for (int row = 1; row < scale_.size(); ++row) {
    const double limit = torque_limits[static_cast<std::size_t>(row)];
    if (std::isfinite(limit)) scale_[row] = kJointWeight / limit;
  }
}

void ContactForces::solve(const InverseDynamics& dynamics, const TreeState& state,
                          std::span<const SupportPoint* const> points,
                          std::span<const ContactPlace> places) {
  count_ = points.size();
  for (std::size_t p = 0; p < count_; ++p) {
    levers_[p] = places[p].position - dynamics.com();
    edges_[p] = friction_pyramid(kFriction, places[p].normal);
    fill_jacobian(state, *points[p], places[p].position, jacobians_[p]);
  }
  const int unknowns = kEdges * static_cast<int>(count_);
  amounts_.setZero(unknowns);
  lower_.setZero(unknowns);
  upper_.setConstant(unknowns, std::numeric_limits<double>::infinity());
  if (count_ > 0) {
    build_system(dynamics);
    qp_.solve(hessian_, gradient_, lower_, upper_, amounts_);
  }
  apply_forces(dynamics);
  if (count_ > 0) relieve_joints(dynamics);
}

void ContactForces::apply_forces(const InverseDynamics& dynamics) {
  unexplained_ = dynamics.needed();
  for (std::size_t i = 1; i < joint_torques_.size(); ++i) {
    joint_torques_[i] = dynamics.forces()[KinematicTree::dof_of(static_cast<int>(i))];
  }
  forces_.clear();
  Eigen::Map<Eigen::VectorXd> torques(joint_torques_.data(),
                                      static_cast<int>(joint_torques_.size()));
  for (std::size_t p = 0; p < count_; ++p) {
    const Vector3d force =
        weight_ * (edges_[p] * amounts_.segment<kEdges>(kEdges * static_cast<int>(p)));
    forces_.push_back(force);
    unexplained_.force -= force;
    unexplained_.torque -= levers_[p].cross(force);
    torques -= jacobians_[p] * force;
  }
}

void ContactForces::fill_jacobian(const TreeState& state, const SupportPoint& point,
                                  const Vector3d& place, RowsOfJoints& jacobian) const {
  jacobian.setZero();
  for (const int dof : tree_->carriers(KinematicTree::dof_of(point.link))) {
    const int link = dof - KinematicTree::dof_of(0);
    if (link > 0) jacobian.row(link) = state.velocity_at(dof, place).transpose();
  }
}

// Forces are divided by the weight, and torques by weight times lever.
void ContactForces::build_system(const InverseDynamics& dynamics) {
  for (int row = 1; row < scale_.size(); ++row) {
    scaled_torques_[row] = scale_[row] * dynamics.forces()[KinematicTree::dof_of(row)];
  }
  hessian_.setIdentity(amounts_.size(), amounts_.size());
  hessian_ *= kForceWeight * kForceWeight;
  gradient_.setZero(amounts_.size());
  const Vector3d force = dynamics.needed().force / weight_;
  const Vector3d torque = dynamics.needed().torque / (weight_ * lever_);
  for (std::size_t p = 0; p < count_; ++p) {
    const int row = kEdges * static_cast<int>(p);
    const Matrix3d turn_p = skew(levers_[p]) / lever_;
    scaled_jacobians_[p].noalias() = weight_ * (scale_.asDiagonal() * jacobians_[p]);
    const Vector3d pull =
        force + turn_p.transpose() * torque + scaled_jacobians_[p].transpose() * scaled_torques_;
    gradient_.segment<kEdges>(row) = -edges_[p].transpose() * pull;
    for (std::size_t q = 0; q <= p; ++q) {
      const Matrix3d turn_q = skew(levers_[q]) / lever_;
      const Matrix3d block = Matrix3d::Identity() + turn_p.transpose() * turn_q +
                             scaled_jacobians_[p].transpose() * scaled_jacobians_[q];
      hessian_.block<kEdges, kEdges>(row, kEdges * static_cast<int>(q)) +=
          edges_[p].transpose() * block * edges_[q];
    }
  }
}

// The problem of relieve_joints() in the edge amounts, for damped_least_squares(). The squared
// excesses over the limits are one-sided terms. Each semismooth Newton step is a quadratic program
// with non-negative amounts.
struct ContactForces::Relief {
  ContactForces& of;
  double length = 1.0;  // Of the last trial.

  double cost() { return of.relief_cost(of.relieved_); }
  void linearise() { of.add_excess(); }
  // The system is positive definite, so it needs no damping.
  std::optional<double> solve(double /*damping*/) {
    if (!of.qp_.solve(of.hessian_, of.gradient_, of.lower_, of.upper_, of.step_).converged)
      return {};
    of.step_ -= of.relieved_;
    return of.step_.norm();
  }
  double try_step(double step_length) {
    length = step_length;
    return of.relief_cost(of.relieved_ + length * of.step_);
  }
  void accept() { of.relieved_ += length * of.step_; }
  void reject() {}
};

// Redistributes the forces if a joint exceeds its limit.
void ContactForces::relieve_joints(const InverseDynamics& dynamics) {
  // Ends at the first step that lowers the cost at none of its trial lengths.
  constexpr LeastSquaresPolicy kPolicy{.max_steps = 12,
                                       .initial_damping = 0.0,
                                       .min_increased = 1.0,
                                       .max_damping = 1.0,
                                       .trials = 5,
                                       .relative_change = 1e-9};
  if (!exceeds_limit()) return;
  read_ratios(dynamics);
  const auto largest = [&](const Eigen::VectorXd& amounts) {
    return (unloaded_ - loading_ * amounts).cwiseAbs().maxCoeff();
  };
  const double before = largest(amounts_);
  if (!(before > 1.0) || !std::isfinite(before)) return;
  build_relief();
  relieved_ = amounts_;
  step_.resize(amounts_.size());
  Relief relief{*this};
  damped_least_squares(relief, kPolicy);
  if (!(largest(relieved_) < before)) return;
  amounts_ = relieved_;
  apply_forces(dynamics);
}

bool ContactForces::exceeds_limit() const {
  for (int row = 1; row < scale_.size(); ++row) {
    const double ratio = scale_[row] / kJointWeight * joint_torques_[static_cast<std::size_t>(row)];
    if (std::abs(ratio) > 1.0) return true;
  }
  return false;
}

void ContactForces::read_ratios(const InverseDynamics& dynamics) {
  loading_.resize(scale_.size(), amounts_.size());
  supply_.resize(6, amounts_.size());
  for (int row = 1; row < scale_.size(); ++row) {
    unloaded_[row] = scale_[row] / kJointWeight * dynamics.forces()[KinematicTree::dof_of(row)];
  }
  for (std::size_t p = 0; p < count_; ++p) {
    const int first = kEdges * static_cast<int>(p);
    loading_.middleCols<kEdges>(first).noalias() = scaled_jacobians_[p] / kJointWeight * edges_[p];
    supply_.block<3, kEdges>(0, first) = edges_[p];
    supply_.block<3, kEdges>(3, first) = skew(levers_[p]) / lever_ * edges_[p];
  }
}

// Builds the terms that do not depend on the excess; the largest keeps the wrench of the forces.
void ContactForces::build_relief() {
  constexpr double kKept = kKeep * kKeep, kJoint = kJointWeight * kJointWeight;
  kept_hessian_.setIdentity(amounts_.size(), amounts_.size());
  kept_hessian_ *= kForceWeight * kForceWeight;
  kept_hessian_.noalias() += kKept * supply_.transpose() * supply_;
  kept_hessian_.noalias() += kJoint * loading_.transpose() * loading_;
  kept_gradient_.noalias() = -kKept * supply_.transpose() * (supply_ * amounts_);
  kept_gradient_.noalias() -= kJoint * loading_.transpose() * unloaded_;
}

// Adds the rows of the joints that exceed their limits at the iterate relieved_.
void ContactForces::add_excess() {
  hessian_ = kept_hessian_;
  gradient_ = kept_gradient_;
  const Eigen::VectorXd ratios = unloaded_ - loading_ * relieved_;
  for (int row = 1; row < ratios.size(); ++row) {
    if (std::abs(ratios[row]) <= kWithin) continue;
    const auto loads = loading_.row(row);
    hessian_.noalias() += loads.transpose() * loads;
    gradient_.noalias() -=
        (unloaded_[row] - std::copysign(kWithin, ratios[row])) * loads.transpose();
  }
}

// Half the sum of squares, without constants.
double ContactForces::relief_cost(const Eigen::VectorXd& amounts) const {
  const Eigen::ArrayXd excess = ((unloaded_ - loading_ * amounts).array().abs() - kWithin).max(0.0);
  return amounts.dot(0.5 * kept_hessian_ * amounts + kept_gradient_) + 0.5 * excess.square().sum();
}

}  // namespace retarget
