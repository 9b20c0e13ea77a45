#pragma once

#include <string>
#include <string_view>

#include "retarget/error.h"
#include "retarget/view.h"

namespace retarget {

/// No vertex of a body's mesh is farther away from the body's origin along an axis, metres.
inline constexpr double kMeshReach = 10.0;

/// A mesh from the bytes of an STL file, binary or text, or of an OBJ file, of which only the shape is
/// read. What is larger than 10 m is taken to be in millimetres.
/// Errors (kInput): no triangles, numbers that are none, corners that there are not.
/// @param file  for messages.
[[nodiscard]] Result<TriangleMesh> read_mesh(std::string_view bytes, const std::string& file);

/// The same in the file's own unit, whatever its size.
[[nodiscard]] Result<TriangleMesh> read_mesh_as_written(std::string_view bytes,
                                                        const std::string& file);

/// Refuses a mesh that goes beyond kMeshReach.
[[nodiscard]] Result<void> check_mesh_reach(const TriangleMesh& mesh, const std::string& file);

/// The mesh with at most so many triangles: vertices are put together cell by cell of a grid, the
/// finest that is coarse enough. Vertices at one place become one in any case.
[[nodiscard]] TriangleMesh simplified(const TriangleMesh& mesh, std::size_t max_triangles);

}  // namespace retarget
