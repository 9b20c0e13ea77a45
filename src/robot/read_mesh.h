#pragma once

#include <string>
#include <string_view>

#include "retarget/error.h"
#include "retarget/triangle_mesh.h"

namespace retarget {

/// No vertex of a body's mesh is farther away from the body's origin along an axis, metres.
inline constexpr double kMeshReach = 10.0;

/// A mesh from the bytes of an STL file, binary or text, of an OBJ or of a COLLADA file (.dae), of which
/// only the shape is read. What is larger than 10 m is taken to be in millimetres.
/// Errors (kInput): no triangles, numbers that are none, corners that there are not.
/// @param file  for messages.
[[nodiscard]] Result<TriangleMesh> read_mesh(std::string_view bytes, const std::string& file);

/// The same in the file's own unit, whatever its size; COLLADA files say what theirs is, and come in metres.
[[nodiscard]] Result<TriangleMesh> read_mesh_as_written(std::string_view bytes,
                                                        const std::string& file);

/// The triangles of a COLLADA file as robots' tools place them: nodes' poses and the unit of length apply,
/// the axis that is up does not. Instances in libraries of nodes are left out.
[[nodiscard]] Result<TriangleMesh> read_collada(std::string_view bytes, const std::string& file);

/// Refuses a mesh that goes beyond kMeshReach.
[[nodiscard]] Result<void> check_mesh_reach(const TriangleMesh& mesh, const std::string& file);

}  // namespace retarget
