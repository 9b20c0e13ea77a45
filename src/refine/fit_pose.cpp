#include "refine/fit_pose.h"

#include <Eigen/Geometry>

#include "math/trigonometry.h"

namespace retarget {

void FitPose::update(const FitModel& model, std::span<const double> qpos) {
  Frame& root = world_from_link[0];
  root.translation = {qpos[0], qpos[1], qpos[2]};
  root.rotation = Eigen::Quaterniond(qpos[3], qpos[4], qpos[5], qpos[6]).toRotationMatrix();
  for (int k = 0; k < 3; ++k) {
    linear[static_cast<std::size_t>(k)] = Eigen::Vector3d::Unit(k);
    angular[static_cast<std::size_t>(3 + k)] = root.rotation.col(k);
  }
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const FitLink& link = model.links[i];
    const Frame& parent = world_from_link[static_cast<std::size_t>(link.parent)];
    const double travel = qpos[static_cast<std::size_t>(link.qpos_address)] - link.reference;
    Frame& world = world_from_link[i];
    world.translation = parent * link.parent_from_link.translation;
    const Eigen::Matrix3d rest = parent.rotation * link.parent_from_link.rotation;
    const Eigen::Vector3d axis = rest.col(2);
    const std::size_t dof = i + FitModel::kBaseDofs - 1;
    if (link.slides) {
      world.rotation = rest;
      world.translation += travel * axis;
      linear[dof] = axis;
      angular[dof].setZero();
      continue;
    }
    const auto [s, c] = portable::sin_cos(travel);
    world.rotation.col(0) = c * rest.col(0) + s * rest.col(1);
    world.rotation.col(1) = c * rest.col(1) - s * rest.col(0);
    world.rotation.col(2) = axis;
    linear[dof] = axis.cross(root.translation - world.translation);
    angular[dof] = axis;
  }
}

}  // namespace retarget
