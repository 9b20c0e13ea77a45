#pragma once

#include <vector>

#include "retarget/error.h"
#include "retarget/robot.h"
#include "solve/dynamics/contact_forces.h"
#include "solve/dynamics/support_points.h"

namespace retarget {

/// Friction coefficient of the floor in the simulation, the same as in the metrics.
inline constexpr double kFloorFriction = ContactForces::kFriction;

/// A joint of a PhysicsModel.
struct PhysicsJoint {
  int joint = 0;       ///< Index into Robot::joints().
  int dof = 0;         ///< Index into velocities of the physics model; its position is at dof + 1.
  double limit = 0.0;  ///< Torque limit, N m (N for slides); infinity if unknown.
};

/// A point of a robot that may touch the floor in a PhysicsModel.
struct PhysicsPoint {
  int body = 0;                                       ///< Body of the physics model.
  Eigen::Vector3d in_body = Eigen::Vector3d::Zero();  ///< Metres.
  double radius = 0.0;                                ///< Metres.
  bool of_sole = false;
};

/// A robot on a floor, as a model for a physics simulation: one body per link of the robot's tree
/// with the inertia of everything fixed to it, the joints with their ranges and rotor inertias, a
/// floor at height 0, and a sphere at every support point of the robot. On a plane, these spheres
/// touch exactly where soles, spheres, capsules and boxes would. Parts of the robot do not touch
/// each other. Joints that the robot's variant holds are rigid.
struct PhysicsModel {
  ModelPtr model;
  std::vector<PhysicsJoint> joints;
  std::vector<PhysicsPoint> points;
  double mass = 0.0;  ///< Kilograms.

  /// Converts a configuration of the robot to one of the physics model.
  void set_positions(const std::vector<double>& robot_qpos, const Robot& robot, double* qpos) const;
  /// Converts a velocity or an acceleration by degree of freedom of Robot::tree().
  void set_rates(const std::vector<double>& of_tree, double* rates) const;
};

/// @param time_step  of the simulation, seconds.
/// Errors (kConfig): a robot with a fixed base, without mass or without soles; a model that MuJoCo
/// does not accept.
[[nodiscard]] Result<PhysicsModel> make_physics_model(const Robot& robot, double time_step);

}  // namespace retarget
