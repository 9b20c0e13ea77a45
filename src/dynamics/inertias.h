#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// Of a mass m at r, about the origin: kg m^2.
[[nodiscard]] inline Eigen::Matrix3d point_inertia(double mass, const Eigen::Vector3d& r) {
  return mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
}

/// Mass of a link of the kinematic tree, and of all bodies that are fixed to it.
struct LinkInertia {
  double mass = 0.0;                                    ///< kg
  Eigen::Vector3d com = Eigen::Vector3d::Zero();        ///< Centre of mass, in the link's frame, m.
  Eigen::Matrix3d about_com = Eigen::Matrix3d::Zero();  ///< In the link's axes, kg m^2.
};

/// Masses of a robot: the model's, and its rotors'.
struct Inertias {
  std::vector<LinkInertia> links;  ///< By link of Robot::tree().
  /// What a joint's rotor adds to its own acceleration, by link, kg m^2 (kg of slides); of the base
  /// 0. The profile's, else the model's `armature`.
  std::vector<double> rotors;
  double mass = 0.0;  ///< Of all links, kg.
};

[[nodiscard]] Inertias make_inertias(const Robot& robot);

}  // namespace retarget
