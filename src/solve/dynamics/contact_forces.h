#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "solve/dynamics/inverse_dynamics.h"
#include "solve/dynamics/support_points.h"
#include "solve/ik/box_qp.h"

namespace retarget {

/// Computes the contact forces at support points whose wrench comes closest to the wrench that a
/// motion requires. The forces lie within friction pyramids with four edges inside the friction
/// cone. The solver is non-negative least squares. Its residuals are the unexplained wrench about
/// the centre of mass (torques divided by a lever) and, with a small weight that selects among
/// equal solutions, the joint torques relative to their limits. If a joint then exceeds its limit,
/// a second solve redistributes the forces: it keeps their wrench and minimises the squared excess
/// over the limits. Owns its scratch memory.
class ContactForces {
 public:
  static constexpr std::size_t kMaxPoints = 20;
  static constexpr double kFriction = 0.8;  ///< Friction coefficient.
  static constexpr double kLever = 0.3;     ///< Lever for a G1, metres: a torque of weight times
                                            ///< lever has the same residual as the weight.
  static constexpr double kJointWeight = 0.02;  ///< Residual of a joint torque at its limit.

  /// @param torque_limits  limits by link of the tree, N m (N for slides); infinity if unknown.
  /// @param weight         weight of the robot, N.
  /// @param lever          length by which torques are divided, metres.
  ContactForces(const KinematicTree& tree, std::span<const double> torque_limits, double weight,
                double lever = kLever);

  /// Computes the contact forces of a motion at an instant.
  /// @param points  support points in contact, at most kMaxPoints.
  /// @param places  positions and normals of these contacts.
  void solve(const InverseDynamics& dynamics, const TreeState& state,
             std::span<const SupportPoint* const> points, std::span<const ContactPlace> places);

  /// The part of the required wrench that the contact forces do not supply, about the centre of
  /// mass: N, N m.
  [[nodiscard]] const Wrench& unexplained() const { return unexplained_; }
  /// Forces at the points, world, N.
  [[nodiscard]] std::span<const Eigen::Vector3d> forces() const { return forces_; }
  /// Joint torques under these forces, by link; 0 for the base. N m (N for slides).
  [[nodiscard]] std::span<const double> joint_torques() const { return joint_torques_; }

 private:
  using RowsOfJoints = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  struct Relief;

  void build_system(const InverseDynamics& dynamics);
  void apply_forces(const InverseDynamics& dynamics);
  void relieve_joints(const InverseDynamics& dynamics);
  [[nodiscard]] bool exceeds_limit() const;
  void read_ratios(const InverseDynamics& dynamics);
  void build_relief();
  void add_excess();
  [[nodiscard]] double relief_cost(const Eigen::VectorXd& amounts) const;
  void fill_jacobian(const TreeState& state, const SupportPoint& point,
                     const Eigen::Vector3d& place, RowsOfJoints& jacobian) const;

  const KinematicTree* tree_;
  double weight_, lever_;
  std::size_t count_ = 0;
  std::vector<Eigen::Vector3d> levers_;  // Vectors from the centre of mass to the points.
  std::vector<Eigen::Matrix<double, 3, 4>> edges_;  // One per point: edges of its friction pyramid.
  std::vector<RowsOfJoints> jacobians_;  // By point: joint torque per unit of force, rows by link.
  std::vector<RowsOfJoints> scaled_jacobians_;  // Residual of a joint per body weight of force.
  Eigen::VectorXd scale_, scaled_torques_;      // One per link.
  Eigen::MatrixXd hessian_;
  Eigen::VectorXd gradient_, lower_, upper_, amounts_;
  BoxQp qp_;
  // The ratios of the joint torques to their limits are unloaded_ - loading_ * amounts, rows by
  // link.
  Eigen::VectorXd unloaded_;
  Eigen::MatrixXd loading_;
  Eigen::MatrixXd supply_;  // Wrench per amount, in units of the weight; rows: force, torque.
  Eigen::MatrixXd kept_hessian_;
  Eigen::VectorXd kept_gradient_, relieved_, step_;
  Wrench unexplained_;
  std::vector<Eigen::Vector3d> forces_;
  std::vector<double> joint_torques_;
};

}  // namespace retarget
