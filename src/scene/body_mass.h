#pragma once

#include <Eigen/Core>

#include "retarget/scene.h"
#include "retarget/triangle_mesh.h"

namespace retarget {

/// The volume that a surface encloses, as the sum of the tetrahedra between its triangles and its
/// first vertex.
struct MeshVolume {
  double size = 0.0;  ///< Cubic metres; negative if the triangles face inward.
  /// Integral of the position over the volume, relative to the first vertex; m^4.
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
};

/// @pre the mesh has vertices
[[nodiscard]] MeshVolume volume_of(const TriangleMesh& mesh);

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
