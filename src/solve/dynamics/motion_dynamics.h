#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/motion.h"
#include "scene/scene_world.h"
#include "solve/dynamics/inverse_dynamics.h"

namespace retarget {

/// Dynamics of a robot's movement at one instant.
struct DynamicsSample {
  /// Wrench that points near the floor cannot supply, about the centre of mass. Force as a share of
  /// the weight; torque in m x weight.
  Eigen::Vector3d unexplained_force = Eigen::Vector3d::Zero();
  Eigen::Vector3d unexplained_torque = unexplained_force;
  Eigen::Vector3d com_acceleration = unexplained_force;  ///< World, m/s^2.
  /// Largest ratio of a joint torque to its limit, and its link; -1 if no limits are known.
  double torque_ratio = 0.0;
  int torque_link = -1;
  bool supported = false;  ///< Whether at least one point may be a contact.
  /// Distance of the zero-moment point inside the support polygon, metres; negative outside. A
  /// force on the floor at the zero-moment point would have the needed moment. NaN without support,
  /// if the required force is less than a fifth of the weight, or if something other than the floor
  /// supports the body.
  double zmp_margin = 0.0;
  /// Needed friction coefficient: horizontal over vertical part of the needed force; NaN as above.
  double friction = 0.0;
  double size = 1.0;  ///< Size of the robot, see body_size().

  /// Whether contacts fail to supply the needed wrench: more than a tenth of the weight is missing,
  /// or a horizontal torque of more than 3 cm x weight for a robot as large as a G1, or the needed
  /// wrench is not finite.
  [[nodiscard]] bool is_bad() const;
  /// The unexplained force that would be as bad as the unexplained horizontal torque.
  [[nodiscard]] double torque_as_force() const;
};

/// Dynamics of a whole motion, sampled along a MotionSpline.
struct MotionDynamics {
  int samples_per_frame = 0;
  double weight = 0.0;        ///< Newtons.
  double floor_height = 0.0;  ///< Height of standing soles, used as the floor height; metres.
  bool knows_torque_limits = false;
  std::vector<DynamicsSample> samples;

  [[nodiscard]] int frame_of(std::size_t sample) const {
    return static_cast<int>(sample) / samples_per_frame;
  }
};

/// Runs inverse dynamics at about 120 samples per second and finds the closest wrench that contacts
/// can supply; see docs/dynamics.md. A point may be a contact if it is lower than 2 cm and slower
/// than 0.5 m/s at the sample or 1/30 s before or after. These values are for a G1; lengths scale
/// with leg length, and speeds with its square root. Bodies of a scene support the robot like the
/// floor, in the direction of their surface, and those that it lifts weigh on the links that touch
/// them (SceneSupports). Samples whose movement is too large to compute
/// with contain NaN.
/// @param scene  around the robot, in the frames of the clip; null: only the floor.
/// @return no samples if the motion has fewer than three frames or the robot has no mass.
[[nodiscard]] MotionDynamics analyse_dynamics(const RobotClip& clip,
                                              const SceneWorld* scene = nullptr);

/// Height of the soles that stand in a motion, metres: MotionDynamics::floor_height, without the
/// dynamics.
[[nodiscard]] double standing_floor(const RobotClip& clip);

}  // namespace retarget
