#pragma once

#include "retarget/scene.h"
#include "retarget/triangle_mesh.h"

namespace retarget {

/// The surface of a shape as triangles with outward normals, in the frame of the shape's body,
/// metres. Round shapes have 32 sides; a plane is a square of 100 m.
[[nodiscard]] TriangleMesh mesh_of_shape(const SceneShape& shape);

}  // namespace retarget
