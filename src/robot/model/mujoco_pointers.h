#pragma once

#include <mujoco/mujoco.h>

#include <memory>

namespace retarget {

struct MujocoSpecDeleter {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};
using MujocoSpec = std::unique_ptr<mjSpec, MujocoSpecDeleter>;

struct MujocoDataDeleter {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using MujocoData = std::unique_ptr<mjData, MujocoDataDeleter>;

}  // namespace retarget
