#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// Inertia about the origin of a point mass (kg) at r (metres), kg m^2.
[[nodiscard]] inline Eigen::Matrix3d point_inertia(double mass, const Eigen::Vector3d& r) {
  return mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
}

/// Inertia of a link of the kinematic tree, including all bodies fixed to it.
struct LinkInertia {
  double mass = 0.0;                                    ///< Kilograms.
  Eigen::Vector3d com = Eigen::Vector3d::Zero();        ///< Centre of mass in the link frame,
                                                        ///< metres.
  Eigen::Matrix3d about_com = Eigen::Matrix3d::Zero();  ///< About the centre of mass, in the link's
                                                        ///< axes, kg m^2.
};

/// Inertias of a robot's links and rotors.
struct Inertias {
  std::vector<LinkInertia> links;  ///< One per link of Robot::tree().
  /// Inertia that a joint's rotor adds to its own acceleration, by link, kg m^2 (kg for slides); 0
  /// for the base. From the profile, else from the model's `armature`.
  std::vector<double> rotors;
  double mass = 0.0;  ///< Total mass, kilograms.
};

[[nodiscard]] Inertias make_inertias(const Robot& robot);

/// Torque limits by link of the robot's tree, N m (N for slides); infinity if unknown.
[[nodiscard]] std::vector<double> torque_limits_of(const Robot& robot);

}  // namespace retarget
