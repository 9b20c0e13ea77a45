#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// A surface of triangles; corners are indices into the vertices.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;  ///< Metres.
  std::vector<std::array<int, 3>> triangles;
};

/// A mesh from the bytes of an STL file, binary or text, or of an OBJ file, of which only the shape is
/// read. What is larger than 10 m is taken to be in millimetres.
/// Errors (kInput): no triangles, numbers that are none, corners that there are not.
/// @param file  for messages.
[[nodiscard]] Result<TriangleMesh> read_mesh(std::string_view bytes, const std::string& file);

/// The mesh with at most so many triangles: vertices are put together cell by cell of a grid, the
/// finest that is coarse enough. Vertices at one place become one in any case.
[[nodiscard]] TriangleMesh simplified(const TriangleMesh& mesh, std::size_t max_triangles);

}  // namespace retarget
