#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "retarget/triangle_mesh.h"

namespace retarget {

/// A mesh file that a model names, and its pose on a body.
struct ModelMesh {
  /// The mesh's body, followed by the bodies that it is fixed to, nearest first.
  struct Carrier {
    std::string body;
    Pose body_from_mesh;  ///< Pose stated in the model; MuJoCo's own pose refers to the mesh's
                          ///< centre.
  };

  std::string file;  ///< File named in the model, prefixed with the model's mesh folder.
  /// A file vertex v maps to scale * (file_from_mesh^-1 * v).
  Pose file_from_mesh;
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  ///< Metres per file unit.
  bool is_visual = false;                           ///< True if it takes no part in contacts.
  std::vector<Carrier> carriers;
  int geom = -1;  ///< Index of the geom in its place, in LoadedModel; -1: not known.
};

/// Surfaces of a robot's bodies, read from the mesh files that its model names.
struct BodySurfaces {
  /// Meshes by body index, in the body's frame; only bodies whose files all exist and are readable.
  /// Geoms without contacts (visual geoms) take precedence; a body that has none uses all of its
  /// meshes.
  std::map<int, TriangleMesh> bodies;
  std::size_t named = 0;  ///< Number of files that the model names for bodies of the robot.
  std::vector<std::string> missing;  ///< Missing files, as the model names them.
  std::vector<Error> unreadable;     ///< One error per body, in body order.
};

/// Reads the STL, OBJ and COLLADA files that a model names (model_meshes), one after the other.
/// Missing or damaged files do not affect the others.
/// @param model   MJCF or URDF; `package://` names and mesh folders are resolved (find_mesh_file).
/// @param folder  searched first; empty: no extra folder.
/// Errors (kConfig): those of model_meshes.
[[nodiscard]] Result<BodySurfaces> read_body_surfaces(const Robot& robot, const std::string& model,
                                                      const std::string& folder = {});

}  // namespace retarget
