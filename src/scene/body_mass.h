#pragma once

#include <Eigen/Core>

#include "retarget/scene.h"

namespace retarget {

/// Mass and centre of mass of a body of a scene.
struct BodyMass {
  double mass = 0.0;                              ///< Kilograms.
  Eigen::Vector3d com = Eigen::Vector3d::Zero();  ///< Frame of the body, metres.
};

/// The mass that a body states, or that of its volume at kObjectDensity. The centre of mass is that
/// of solid shapes of equal density; shapes that overlap count twice. A plane has no mass, and a
/// mesh that encloses nothing counts as the box around it.
[[nodiscard]] BodyMass body_mass(const SceneBody& body);

}  // namespace retarget
