#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/math/gravity.h"
#include "retarget/kinematic_tree.h"
#include "solve/dynamics/inertias.h"

namespace retarget {

/// A wrench about a point: world axes, N and N m.
struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

/// The zero-moment point: the point of a horizontal plane about which the wrench has no horizontal
/// moment. World x and y, metres.
/// @param needed  wrench about the centre of mass; its force points upwards.
/// @param com     centre of mass, world, metres.
/// @param height  height of the centre of mass above the plane, metres.
[[nodiscard]] Eigen::Vector2d zero_moment_point(const Wrench& needed, const Eigen::Vector3d& com,
                                                double height);

/// A force that a link exerts on an object that it carries.
struct LinkLoad {
  int link = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< World, metres.
  Eigen::Vector3d force = Eigen::Vector3d::Zero();     ///< Force on the object, world, N.
};

/// Inverse dynamics without contacts, by the recursive Newton-Euler algorithm (Featherstone, "Rigid
/// Body Dynamics Algorithms", chapter 5) in world axes. Owns its scratch memory; compute() does not
/// allocate. Keeps pointers to the tree and the inertias.
class InverseDynamics {
 public:
  explicit InverseDynamics(const KinematicTree& tree, const Inertias& inertias);

  /// Computes the required forces of a motion state; the other members then refer to it.
  /// @param state         pose of the robot.
  /// @param velocity      one entry per degree of freedom of the tree, per second: 0-2 linear
  ///   velocity of the base's origin in the world, 3-5 angular velocity in the base's own axes,
  ///   then joint velocities.
  /// @param acceleration  time derivatives of the velocities.
  /// @param loads         forces on carried objects.
  void compute(const TreeState& state, std::span<const double> velocity,
               std::span<const double> acceleration, std::span<const LinkLoad> loads = {});

  /// Whether the last result is finite.
  [[nodiscard]] bool is_finite() const;
  /// Generalised forces by degree of freedom: force on the base in the world, N; torque about its
  /// origin in its own axes, N m; joint torques, N m (N for slides).
  [[nodiscard]] std::span<const double> forces() const { return forces_; }
  /// Centre of mass of the whole robot, world, m, and its acceleration, m/s^2.
  [[nodiscard]] const Eigen::Vector3d& com() const { return com_; }
  [[nodiscard]] Eigen::Vector3d com_acceleration() const;
  /// Velocity of the centre of mass, world, m/s.
  [[nodiscard]] const Eigen::Vector3d& com_velocity() const { return com_velocity_; }
  /// The external wrench that the motion requires, about the centre of mass: m (c'' + g), the rate
  /// of the angular momentum, and the wrench of the loads. Ignores the angular momentum of rotors.
  [[nodiscard]] const Wrench& needed() const { return needed_; }
  /// World velocity of a point that moves with a link, m/s.
  [[nodiscard]] Eigen::Vector3d velocity_of(int link, const Eigen::Vector3d& point,
                                            const TreeState& state) const;
  /// Angular momentum about the centre of mass, kg m^2/s.
  [[nodiscard]] const Eigen::Vector3d& angular_momentum() const { return angular_momentum_; }

 private:
  struct LinkMotion {
    Eigen::Vector3d velocity, angular;           // Of the link's origin.
    Eigen::Vector3d acceleration, angular_rate;  // Includes gravity as an upward acceleration.
  };

  void move_links(const TreeState& state, std::span<const double> velocity,
                  std::span<const double> acceleration);
  void weigh_links(const TreeState& state);
  void add_loads(const TreeState& state, std::span<const LinkLoad> loads);
  void gather_forces(const TreeState& state, std::span<const double> acceleration);

  const KinematicTree* tree_;
  const Inertias* inertias_;
  std::vector<LinkMotion> motions_;
  std::vector<Wrench> wrenches_;  // On a link and its descendants, about the link's origin.
  std::vector<double> forces_;
  Eigen::Vector3d com_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d com_velocity_ = com_;
  Eigen::Vector3d angular_momentum_ = com_;
  Eigen::Vector3d load_ = com_;  // Sum of the loads' forces.
  Wrench needed_;
};

}  // namespace retarget
