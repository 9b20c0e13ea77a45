#include "scene/mesh_volume.h"

#include <Eigen/Geometry>

namespace retarget {

MeshVolume volume_of(const TriangleMesh& mesh) {
  MeshVolume volume;
  // Relative to a vertex, so that a closed mesh far from the origin keeps its digits.
  const Eigen::Vector3d& from = mesh.vertices.front();
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto corner = [&](int index) -> Eigen::Vector3d {
      return mesh.vertices[static_cast<std::size_t>(index)] - from;
    };
    const double part = corner(a).dot(corner(b).cross(corner(c))) / 6.0;
    volume.size += part;
    volume.moment += part * (corner(a) + corner(b) + corner(c)) / 4.0;
  }
  return volume;
}

}  // namespace retarget
