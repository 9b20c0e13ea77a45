#pragma once

#include <mujoco/mujoco.h>

#include <vector>

#include "robot/model_meshes.h"

namespace retarget {

/// Finds out where meshes are on bodies, whose own frames MuJoCo moves to the meshes' centres: a point in
/// the place of a mesh stays where the model has it, frames, defaults and angles all resolved.
class MeshGeoms {
 public:
  /// Puts a small sphere in the place of every mesh of a model that is not compiled yet.
  void replace(mjSpec* spec);

  /// @param model  what that model was compiled to.
  [[nodiscard]] std::vector<ModelMesh> find(const mjModel& model) const;

 private:
  struct Replaced {
    mjsElement* geom = nullptr;
    ModelMesh mesh;  // without carriers
  };
  std::vector<Replaced> replaced_;
};

}  // namespace retarget
