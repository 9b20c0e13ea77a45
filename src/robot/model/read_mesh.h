#pragma once

#include <string>
#include <string_view>

#include "retarget/error.h"
#include "retarget/triangle_mesh.h"

namespace retarget {

/// Maximum distance of a mesh vertex from the body's origin along any axis, metres.
inline constexpr double kMeshReach = 10.0;

/// Reads a mesh from the bytes of an STL file (binary or text), an OBJ or a COLLADA file (.dae);
/// only geometry is read. A mesh larger than 10 m is assumed to be in millimetres.
/// Errors (kInput): no triangles, invalid numbers, corner indices out of range.
/// @param file  used in messages.
[[nodiscard]] Result<TriangleMesh> read_mesh(std::string_view bytes, const std::string& file);

/// Reads a mesh without guessing its unit: STL and OBJ in the file's unit, COLLADA, which states
/// its unit, in metres.
[[nodiscard]] Result<TriangleMesh> read_mesh_as_written(std::string_view bytes,
                                                        const std::string& file);

/// Reads the triangles of a COLLADA file as robot tools place them: node poses and the unit of
/// length apply, the up axis does not. Instances in node libraries are ignored.
[[nodiscard]] Result<TriangleMesh> read_collada(std::string_view bytes, const std::string& file);

/// Rejects a mesh that exceeds kMeshReach.
[[nodiscard]] Result<void> check_mesh_reach(const TriangleMesh& mesh, const std::string& file);

}  // namespace retarget
