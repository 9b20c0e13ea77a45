#pragma once

#include <Eigen/Core>
#include <vector>

#include "dynamics/inverse_dynamics.h"
#include "retarget/motion.h"

namespace retarget {

/// What a robot's movement asks for at one instant.
struct DynamicsSample {
  /// Without a cause: what points near the floor cannot supply, about the centre of mass. Shares of
  /// the weight; m x weight.
  Eigen::Vector3d unexplained_force = Eigen::Vector3d::Zero();
  Eigen::Vector3d unexplained_torque = unexplained_force;
  Eigen::Vector3d com_acceleration = unexplained_force;  ///< m/s^2, world.
  /// Largest share of a joint's torque limit, and its link; -1: no limits are known.
  double torque_ratio = 0.0;
  int torque_link = -1;
  bool supported = false;  ///< Some point may be pushed against.
  /// How far inside the polygon of support the point is at which a force with the needed moment
  /// would act on the floor (the zero-moment point); metres, negative outside. NaN where nothing
  /// supports, or less than a fifth of the weight has to be held.
  double zmp_margin = 0.0;
  /// Friction that the needed force asks for: its horizontal part by its vertical one; NaN likewise.
  double friction = 0.0;
  double size = 1.0;  ///< Of the robot: body_size.

  /// Contacts cannot supply what is needed: more than a tenth of the weight is missing, or a torque
  /// across the vertical of more than 3 cm x weight, of a robot as large as a G1.
  [[nodiscard]] bool is_bad() const;
  /// The unexplained force that would be as bad as the unexplained torque across the vertical is.
  [[nodiscard]] double torque_as_force() const;
};

/// Of a whole motion, sampled along a MotionSpline.
struct MotionDynamics {
  int samples_per_frame = 0;
  double weight = 0.0;        ///< N
  double floor_height = 0.0;  ///< Of soles that stand, metres; it is taken for the floor.
  bool knows_torque_limits = false;
  std::vector<DynamicsSample> samples;

  [[nodiscard]] int frame_of(std::size_t sample) const {
    return static_cast<int>(sample) / samples_per_frame;
  }
};

/// Inverse dynamics at about 120 samples a second, and the nearest that contacts can supply: see
/// docs/dynamics.md. What may be pushed against is lower than 2 cm and slower than 0.5 m/s then or a
/// 30th of a second before or after; lengths are a G1's, others' in proportion to their legs, and
/// speeds to the square root of that.
/// @return no samples of a motion with fewer than three frames, or of a robot without mass.
[[nodiscard]] MotionDynamics analyse_dynamics(const RobotClip& clip);

}  // namespace retarget
