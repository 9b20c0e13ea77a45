#pragma once

#include <mujoco/mujoco.h>

#include <cstddef>
#include <memory>

#include "base/math/gravity.h"
#include "retarget/robot.h"

namespace retarget {

using ModelPointer = std::unique_ptr<mjModel, void (*)(mjModel*)>;

/// MuJoCo's model of a robot for inverse dynamics with only weight and inertia.
inline ModelPointer inverse_model(const Robot& robot) {
  ModelPointer model(mj_copyModel(nullptr, robot.model()), mj_deleteModel);
  model->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_CONTACT | mjDSBL_LIMIT;
  mju_zero(model->dof_damping, model->nv);
  mju_zero(model->dof_frictionloss, model->nv);
  mju_zero(model->jnt_stiffness, model->njnt);
  model->opt.gravity[2] = -kGravity;
  for (std::size_t j = 0; j < robot.joints().size(); ++j) {
    model->dof_armature[robot.joints()[j].dof_address] = robot.rotor_inertia(static_cast<int>(j));
  }
  return model;
}

}  // namespace retarget
