#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/pose.h"

namespace retarget {

/// A mesh file that a model names, and where it is on a body.
struct ModelMesh {
  /// The body that has it, then those that this one is fixed to, nearest first.
  struct Carrier {
    std::string body;
    Pose body_from_mesh;  ///< As written; MuJoCo's own is about the mesh's centre.
  };

  std::string file;  ///< As the model names it, behind the model's folder of meshes.
  /// A vertex v of the file is at file_from_mesh^-1 * v times the scale.
  Pose file_from_mesh;
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  ///< Metres of a unit of the file.
  bool is_visual = false;                           ///< Takes no part in contacts.
  std::vector<Carrier> carriers;
};

/// The meshes of an MJCF or URDF file. None of them is read, nor need it be there.
/// Errors (kConfig): load_model's; mesh files outside the model's package (check_model).
[[nodiscard]] Result<std::vector<ModelMesh>> model_meshes(const std::string& path);

}  // namespace retarget
