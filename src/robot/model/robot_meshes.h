#pragma once

#include <cstddef>

#include "retarget/triangle_mesh.h"

namespace retarget {

/// Simplifies a mesh to at most this many triangles by clustering vertices in the finest sufficient
/// grid. Always merges coincident vertices.
[[nodiscard]] TriangleMesh simplified(const TriangleMesh& mesh, std::size_t max_triangles);

}  // namespace retarget
