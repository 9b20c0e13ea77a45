#pragma once

#include <mujoco/mujoco.h>

#include <vector>

#include "robot/model/model_meshes.h"

namespace retarget {

/// Finds the poses of meshes on bodies. MuJoCo moves a mesh's own frame to its centre; a point geom
/// in place of the mesh keeps the model's pose, with frames, defaults and angles resolved.
class MeshGeoms {
 public:
  /// Replaces every mesh geom of an uncompiled model with a small sphere.
  void replace(mjSpec* spec);

  /// @param model  the compiled model.
  [[nodiscard]] std::vector<ModelMesh> find(const mjModel& model) const;

 private:
  struct Replaced {
    mjsElement* geom = nullptr;
    ModelMesh mesh;  // Without carriers.
  };
  std::vector<Replaced> replaced_;
};

}  // namespace retarget
