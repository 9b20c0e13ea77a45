#include "solve/dynamics/inverse_dynamics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace retarget {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Eigen::Vector2d zero_moment_point(const Wrench& needed, const Eigen::Vector3d& com, double height) {
  return com.head<2>() + Eigen::Vector2d(-needed.torque.y() - height * needed.force.x(),
                                         needed.torque.x() - height * needed.force.y()) /
                             needed.force.z();
}

InverseDynamics::InverseDynamics(const KinematicTree& tree, const Inertias& inertias)
    : tree_(&tree),
      inertias_(&inertias),
      motions_(tree.links().size()),
      wrenches_(tree.links().size()),
      forces_(tree.dof_count()) {}

void InverseDynamics::compute(const TreeState& state, std::span<const double> velocity,
                              std::span<const double> acceleration,
                              std::span<const LinkLoad> loads) {
  move_links(state, velocity, acceleration);
  weigh_links(state);
  add_loads(state, loads);
  gather_forces(state, acceleration);
  const Vector3d lever = state.origin() - com_;
  needed_ = {wrenches_[0].force, wrenches_[0].torque + lever.cross(wrenches_[0].force)};
}

bool InverseDynamics::is_finite() const {
  return com_.allFinite() && needed_.force.allFinite() && needed_.torque.allFinite() &&
         std::ranges::all_of(forces_, [](double force) { return std::isfinite(force); });
}

Vector3d InverseDynamics::com_acceleration() const {
  return (needed_.force - load_) / inertias_->mass - kGravity * Vector3d::UnitZ();
}

Vector3d InverseDynamics::velocity_of(int link, const Vector3d& point,
                                      const TreeState& state) const {
  const LinkMotion& motion = motions_[static_cast<std::size_t>(link)];
  return motion.velocity +
         motion.angular.cross(point -
                              state.world_from_link[static_cast<std::size_t>(link)].translation);
}

void InverseDynamics::move_links(const TreeState& state, std::span<const double> velocity,
                                 std::span<const double> acceleration) {
  const Matrix3d world_from_base = state.world_from_link[0].rotation.toRotationMatrix();
  const auto three = [](std::span<const double> values, int from) {
    return Vector3d(values[from], values[from + 1], values[from + 2]);
  };
  motions_[0] = {three(velocity, 0), world_from_base * three(velocity, 3),
                 three(acceleration, 0) + kGravity * Vector3d::UnitZ(),
                 world_from_base * three(acceleration, 3)};
  for (std::size_t i = 1; i < motions_.size(); ++i) {
    const KinematicTree::Link& link = tree_->links()[i];
    const LinkMotion& parent = motions_[link.parent];
    LinkMotion& motion = motions_[i];
    const int dof = KinematicTree::dof_of(static_cast<int>(i));
    const Vector3d r =
        state.world_from_link[i].translation - state.world_from_link[link.parent].translation;
    motion.angular = parent.angular;
    motion.angular_rate = parent.angular_rate;
    motion.velocity = parent.velocity + parent.angular.cross(r);
    motion.acceleration = parent.acceleration + parent.angular_rate.cross(r) +
                          parent.angular.cross(parent.angular.cross(r));
    if (link.slides) {
      const Vector3d travel = state.linear[dof] * velocity[dof];
      motion.velocity += travel;
      motion.acceleration +=
          2.0 * parent.angular.cross(travel) + state.linear[dof] * acceleration[dof];
    } else {
      const Vector3d turn = state.angular[dof] * velocity[dof];
      motion.angular += turn;
      motion.angular_rate += state.angular[dof] * acceleration[dof] + parent.angular.cross(turn);
    }
  }
}

// Computes the wrench that each link alone requires, and the sums over all links.
void InverseDynamics::weigh_links(const TreeState& state) {
  com_.setZero();
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    com_ += inertias_->links[i].mass * (state.world_from_link[i] * inertias_->links[i].com);
  }
  if (inertias_->mass > 0.0) com_ /= inertias_->mass;
  angular_momentum_.setZero();
  com_velocity_.setZero();
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    const LinkInertia& inertia = inertias_->links[i];
    const LinkMotion& motion = motions_[i];
    const Matrix3d axes = state.world_from_link[i].rotation.toRotationMatrix();
    const Vector3d com = axes * inertia.com;
    const Matrix3d about_com = axes * inertia.about_com * axes.transpose();
    const Vector3d& w = motion.angular;
    const Vector3d spin = about_com * w;
    const Vector3d force = inertia.mass * (motion.acceleration + motion.angular_rate.cross(com) +
                                           w.cross(w.cross(com)));
    wrenches_[i] = {force, com.cross(force) + about_com * motion.angular_rate + w.cross(spin)};
    const Vector3d lever = state.world_from_link[i].translation + com - com_;
    const Vector3d velocity = motion.velocity + w.cross(com);
    angular_momentum_ += spin + inertia.mass * lever.cross(velocity);
    com_velocity_ += inertia.mass * velocity;
  }
  if (inertias_->mass > 0.0) com_velocity_ /= inertias_->mass;
}

void InverseDynamics::add_loads(const TreeState& state, std::span<const LinkLoad> loads) {
  load_.setZero();
  for (const LinkLoad& load : loads) {
    const auto link = static_cast<std::size_t>(load.link);
    const Vector3d lever = load.position - state.world_from_link[link].translation;
    wrenches_[link].force += load.force;
    wrenches_[link].torque += lever.cross(load.force);
    load_ += load.force;
  }
}

void InverseDynamics::gather_forces(const TreeState& state, std::span<const double> acceleration) {
  for (std::size_t i = motions_.size() - 1; i > 0; --i) {
    const KinematicTree::Link& link = tree_->links()[i];
    const int dof = KinematicTree::dof_of(static_cast<int>(i));
    const Wrench& wrench = wrenches_[i];
    forces_[dof] = (link.slides ? state.linear[dof].dot(wrench.force)
                                : state.angular[dof].dot(wrench.torque)) +
                   inertias_->rotors[i] * acceleration[dof];
    const Vector3d r =
        state.world_from_link[i].translation - state.world_from_link[link.parent].translation;
    wrenches_[link.parent].force += wrench.force;
    wrenches_[link.parent].torque += wrench.torque + r.cross(wrench.force);
  }
  const Vector3d torque =
      state.world_from_link[0].rotation.toRotationMatrix().transpose() * wrenches_[0].torque;
  for (int k = 0; k < 3; ++k) {
    forces_[k] = wrenches_[0].force[k];
    forces_[3 + k] = torque[k];
  }
}

}  // namespace retarget
