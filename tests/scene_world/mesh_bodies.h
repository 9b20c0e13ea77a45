#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>

#include "retarget/scene.h"
#include "retarget/triangle_mesh.h"
#include "scene/scene_shapes.h"

namespace retarget {

/// The surface of a box about the origin, with triangles that face outward.
/// @param lid  without it, the side at the top is open.
inline TriangleMesh box_mesh(const Eigen::Vector3d& half, bool lid = true) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) != 0 ? half.x() : -half.x(),
                               (i & 2) != 0 ? half.y() : -half.y(),
                               (i & 4) != 0 ? half.z() : -half.z());
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {1, 3, 7},
                    {1, 7, 5}, {3, 2, 6}, {3, 6, 7}, {2, 0, 4}, {2, 4, 6}};
  if (lid) {
    mesh.triangles.push_back({4, 5, 7});
    mesh.triangles.push_back({4, 7, 6});
  }
  return mesh;
}

inline SceneBody body_of(SceneShape shape) {
  SceneBody body;
  body.name = "it";
  body.shapes.push_back(std::move(shape));
  return body;
}

inline SceneBody body_of(const TriangleMesh& mesh) {
  SceneShape shape;
  shape.type = SceneShape::Type::kMesh;
  shape.mesh = std::make_shared<TriangleMesh>(mesh);
  return body_of(shape);
}

}  // namespace retarget
