#include "solve/dynamics/contact_forces.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "base/math/se3.h"
#include "solve/dynamics/force_cone.h"

namespace retarget {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kEdges = ForceCone::kEdges;
constexpr int kUnknowns = kEdges * static_cast<int>(ContactForces::kMaxPoints);
// Weight of a force, per body weight: makes the problem strictly convex.
constexpr double kForceWeight = 0.003;

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
      hessian_(kUnknowns, kUnknowns),
      gradient_(kUnknowns),
      lower_(Eigen::VectorXd::Zero(kUnknowns)),
      upper_(Eigen::VectorXd::Constant(kUnknowns, std::numeric_limits<double>::infinity())),
      amounts_(Eigen::VectorXd::Zero(kUnknowns)),
      qp_(kUnknowns),
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
  amounts_.setZero();
  if (count_ > 0) {
    build_system(dynamics);
    qp_.solve(hessian_, gradient_, lower_, upper_, amounts_);
  }
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
  hessian_.setIdentity();
  hessian_ *= kForceWeight * kForceWeight;
  gradient_.setZero();
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

}  // namespace retarget
