#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "dynamics/inverse_dynamics.h"
#include "dynamics/support_points.h"
#include "ik/box_qp.h"

namespace retarget {

/// The forces at points of support that come nearest to what a movement needs: within friction
/// pyramids (four edges inside the cone), non-negative least squares of the needed wrench about the
/// centre of mass, torques divided by a lever, and of the joints' torques in terms of their limits
/// with a small weight, which chooses among equals. Owns its scratch memory.
class ContactForces {
 public:
  static constexpr std::size_t kMaxPoints = 10;
  static constexpr double kFriction = 0.8;
  static constexpr double kLever = 0.3;         ///< m, of a G1: W at this lever counts as W.
  static constexpr double kJointWeight = 0.02;  ///< Of a joint torque at its limit.

  /// @param torque_limits  by link of the tree, N m (N); infinity: none is known.
  /// @param lever          m: a torque of the weight times it counts as much as the weight.
  ContactForces(const KinematicTree& tree, std::span<const double> torque_limits, double weight,
                double lever = kLever);

  /// @param points  of support, at most kMaxPoints; places: their world positions.
  void solve(const InverseDynamics& dynamics, const TreeState& state,
             std::span<const SupportPoint* const> points, std::span<const Eigen::Vector3d> places);

  /// What remains without a cause, about the centre of mass: N, N m.
  [[nodiscard]] const Wrench& unexplained() const { return unexplained_; }
  /// Forces at the points, world, N.
  [[nodiscard]] std::span<const Eigen::Vector3d> forces() const { return forces_; }
  /// Of the joints with these forces, by link; of the base 0. N m (N of slides).
  [[nodiscard]] std::span<const double> joint_torques() const { return joint_torques_; }

 private:
  using RowsOfJoints = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  void build_system(const InverseDynamics& dynamics);
  void fill_jacobian(const TreeState& state, const SupportPoint& point,
                     const Eigen::Vector3d& place, RowsOfJoints& jacobian) const;

  const KinematicTree* tree_;
  double weight_, lever_;
  std::size_t count_ = 0;
  std::vector<Eigen::Vector3d> levers_;  // from the centre of mass to the points
  std::vector<RowsOfJoints> jacobians_;  // by point: rows by link, joint torque per unit of force
  std::vector<RowsOfJoints> scaled_jacobians_;  // in terms of limits and weights
  Eigen::VectorXd scale_, scaled_torques_;      // by link
  Eigen::MatrixXd hessian_;
  Eigen::VectorXd gradient_, lower_, upper_, amounts_;
  BoxQp qp_;
  Wrench unexplained_;
  std::vector<Eigen::Vector3d> forces_;
  std::vector<double> joint_torques_;
};

}  // namespace retarget
