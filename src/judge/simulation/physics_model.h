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
  int dof = 0;         ///< Index into MuJoCo's qvel; its position is at dof + 1 of qpos.
  double limit = 0.0;  ///< Torque limit, N m (N for slides); infinity if unknown.
};

/// A point of a robot that may touch the floor in a PhysicsModel.
struct PhysicsPoint {
  int body = 0;                                       ///< Body of the physics model.
  Eigen::Vector3d in_body = Eigen::Vector3d::Zero();  ///< Position in the body frame, metres.
  double radius = 0.0;                                ///< Radius of its sphere, metres.
  bool of_sole = false;                               ///< Whether the point belongs to a sole.
};

/// A MuJoCo model of a robot on a floor. It has one body per link of the robot's tree with the
/// inertias of all bodies fixed to the link, the joints with their ranges and rotor inertias, a
/// floor at height 0, and a collision sphere at every support point of the robot. On a plane, these
/// spheres have the same contacts as soles, spheres, capsules and boxes. Parts of the robot do not
/// collide with each other. Joints that the robot's variant locks are rigid.
struct PhysicsModel {
  ModelPtr model;
  std::vector<PhysicsJoint> joints;
  std::vector<PhysicsPoint> points;  ///< Points in the order of make_support_points().
  double mass = 0.0;                 ///< Kilograms.

  /// Converts a configuration of the robot (laid out as in RobotClip) to a qpos of this model.
  void set_positions(const std::vector<double>& robot_qpos, const Robot& robot, double* qpos) const;
  /// Converts a velocity or an acceleration from the degrees of freedom of Robot::tree() to those
  /// of this model.
  void set_rates(const std::vector<double>& of_tree, double* rates) const;
};

/// Makes the model of a robot.
/// Errors (kConfig): a robot with a fixed base, without mass or without soles; a model that MuJoCo
/// does not accept.
/// @param time_step  time step of the simulation, seconds.
[[nodiscard]] Result<PhysicsModel> make_physics_model(const Robot& robot, double time_step);

}  // namespace retarget
