#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/pose.h"

namespace retarget {

/// A mesh file that a model names, and its pose on a body.
struct ModelMesh {
  /// The mesh's body, followed by the bodies that it is fixed to, nearest first.
  struct Carrier {
    std::string body;
    Pose body_from_mesh;  ///< As in the model; MuJoCo's own pose refers to the mesh's centre.
  };

  std::string file;  ///< As in the model, prefixed with the model's mesh folder.
  /// A file vertex v maps to scale * (file_from_mesh^-1 * v).
  Pose file_from_mesh;
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  ///< Metres per file unit.
  bool is_visual = false;                           ///< True if it takes no part in contacts.
  std::vector<Carrier> carriers;
  int geom = -1;  ///< Index of the geom in its place, in LoadedModel; -1: not known.
};

/// Lists the meshes of an MJCF or URDF file without reading them; the mesh files need not exist.
/// Errors (kConfig): load_model's; mesh files outside the model's package (check_model).
[[nodiscard]] Result<std::vector<ModelMesh>> model_meshes(const std::string& path);

}  // namespace retarget
