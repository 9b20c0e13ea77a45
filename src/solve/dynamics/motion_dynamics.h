#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/motion.h"
#include "scene/scene_world.h"
#include "solve/dynamics/inverse_dynamics.h"

namespace retarget {

/// Dynamics of a robot's motion at one instant.
struct DynamicsSample {
  /// The part of the required wrench that the contacts cannot supply, about the centre of mass.
  /// Force in body weights, torque in m x weight.
  Eigen::Vector3d unexplained_force = Eigen::Vector3d::Zero();
  Eigen::Vector3d unexplained_torque = unexplained_force;
  Eigen::Vector3d com_acceleration = unexplained_force;  ///< World, m/s^2.
  /// Largest ratio of a joint torque to its limit, and its link; -1 if no limits are known.
  double torque_ratio = 0.0;
  int torque_link = -1;
  bool supported = false;  ///< Whether at least one point may be a contact.
  /// Distance of the zero-moment point from the edge of the support polygon, metres; negative
  /// outside. NaN without support, if the required vertical force is less than a fifth of the
  /// weight, or if a body of the scene supports the robot.
  double zmp_margin = 0.0;
  /// Required friction coefficient: ratio of the horizontal to the vertical part of the required
  /// force. NaN in the same cases as zmp_margin.
  double friction = 0.0;
  double size = 1.0;  ///< Size of the robot, see body_size().

  /// Whether the contacts fail to supply the required wrench: the unexplained force exceeds a tenth
  /// of the weight, or the unexplained horizontal torque exceeds 3 cm x weight (for a robot of a
  /// G1's size), or a value is not finite.
  [[nodiscard]] bool is_bad() const;
  /// The unexplained horizontal torque, converted to the force with the same ratio to its threshold
  /// in is_bad(); body weights.
  [[nodiscard]] double torque_as_force() const;
};

/// Dynamics of a whole motion, sampled along a MotionSpline.
struct MotionDynamics {
  int samples_per_frame = 0;
  double weight = 0.0;               ///< Weight of the robot, newtons.
  double floor_height = 0.0;         ///< Height of the soles while they stand, metres.
  bool knows_torque_limits = false;  ///< Whether the torque limit of at least one joint is known.
  std::vector<DynamicsSample> samples;

  /// The frame at or before a sample.
  [[nodiscard]] int frame_of(std::size_t sample) const {
    return static_cast<int>(sample) / samples_per_frame;
  }
};

/// Runs inverse dynamics at about 120 samples per second and finds the closest wrench that contacts
/// can supply (docs/dynamics.md). A point may be a contact if it is lower than 2 cm and slower than
/// 0.5 m/s at the sample or at most 1/30 s before or after. These values are for a G1; lengths
/// scale with the leg length, and speeds with its square root. Bodies of a scene support the robot
/// along their surface normals. Lifted bodies are loads of the links that touch them
/// (SceneSupports). Samples contain NaN where values overflow.
/// @param scene  scene around the robot, one pose per frame of the clip; null: only the floor.
/// @return no samples if the motion has fewer than three frames or the robot has no mass.
[[nodiscard]] MotionDynamics analyse_dynamics(const RobotClip& clip,
                                              const SceneWorld* scene = nullptr);

/// Height of the lowest level on which the soles of a motion stand, metres
/// (lowest_standing_height()).
[[nodiscard]] double standing_floor(const RobotClip& clip);

}  // namespace retarget
