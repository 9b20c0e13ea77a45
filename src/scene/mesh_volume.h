#pragma once

#include <Eigen/Core>

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

}  // namespace retarget
