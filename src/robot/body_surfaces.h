#pragma once

#include <map>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/robot.h"
#include "retarget/triangle_mesh.h"

namespace retarget {

/// Surfaces of a robot's bodies from the mesh files that its model names.
struct BodySurfaces {
  /// By body, in its frame; those of which every file is there and could be read. A body that is shown
  /// by geoms without contacts has these, else all of its meshes.
  std::map<int, TriangleMesh> bodies;
  std::size_t named = 0;             ///< Files that the model names for bodies of the robot.
  std::vector<std::string> missing;  ///< Of these, as the model names them.
  std::vector<Error> unreadable;     ///< A body each, in the order of the bodies.
};

/// Reads the STL, OBJ and COLLADA files that a model names (model_meshes), one after the other: what is
/// missing or damaged leaves the others as they are.
/// @param model   MJCF or URDF; `package://` and folders of meshes are followed (find_mesh_file).
/// @param folder  in which files are looked for first; empty: none.
/// Errors (kConfig): those of model_meshes.
[[nodiscard]] Result<BodySurfaces> read_body_surfaces(const Robot& robot, const std::string& model,
                                                      const std::string& folder = {});

}  // namespace retarget
