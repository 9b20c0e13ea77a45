#pragma once

#include <cstddef>

#include "retarget/triangle_mesh.h"

namespace retarget {

/// The mesh with at most so many triangles: vertices are put together cell by cell of a grid, the
/// finest that is coarse enough. Vertices at one place become one in any case.
[[nodiscard]] TriangleMesh simplified(const TriangleMesh& mesh, std::size_t max_triangles);

}  // namespace retarget
