#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "io/gltf_writer.h"
#include "retarget/pose.h"
#include "retarget/robot.h"

namespace retarget {

/// Triangles with smooth normals, seen from outside counter-clockwise.
struct GltfMesh {
  std::vector<float> positions, normals;  ///< x y z of each vertex; metres.
  std::vector<std::uint32_t> triangles;   ///< Three vertices each.

  [[nodiscard]] std::size_t vertex_count() const { return positions.size() / 3; }

  /// A cylinder along z with half spheres at its ends; of no length: a sphere.
  void add_capsule(const Pose& pose, double radius, double half_length);
  /// A capsule between two points.
  void add_line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius);
  void add_box(const Pose& pose, const Eigen::Vector3d& half_size);
  /// In the frame of its body.
  void add_shape(const CollisionShape& shape);

 private:
  void add_vertex(const Pose& pose, const Eigen::Vector3d& place, const Eigen::Vector3d& normal);
};

/// A primitive of a mesh with the attributes POSITION and NORMAL.
/// @pre the mesh has triangles
[[nodiscard]] GltfWriter::Json gltf_primitive(GltfWriter& writer, const GltfMesh& mesh,
                                              int material);

}  // namespace retarget
