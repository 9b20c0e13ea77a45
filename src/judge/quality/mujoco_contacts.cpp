#include "judge/quality/mujoco_contacts.h"

#include <mujoco/mujoco.h>

#include <algorithm>

namespace retarget {

MujocoContacts::MujocoContacts(std::shared_ptr<const Robot> robot) : robot_(std::move(robot)) {}

MujocoContacts::~MujocoContacts() {
  mj_deleteData(data_);
}

double MujocoContacts::depth(std::span<const double> qpos,
                             std::span<const std::pair<int, int>> geoms) {
  if (geoms.empty()) return 0.0;
  const mjModel* model = robot_->model();
  if (data_ == nullptr) data_ = mj_makeData(model);
  std::ranges::copy(qpos, data_->qpos);
  mj_kinematics(model, data_);
  mj_comPos(model, data_);
  mj_collision(model, data_);
  double deepest = 0.0;
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& contact = data_->contact[i];
    const bool listed = std::ranges::any_of(geoms, [&contact](const std::pair<int, int>& pair) {
      return pair == std::pair(contact.geom[0], contact.geom[1]) ||
             pair == std::pair(contact.geom[1], contact.geom[0]);
    });
    if (listed) deepest = std::max(deepest, -contact.dist);
  }
  return deepest;
}

}  // namespace retarget
