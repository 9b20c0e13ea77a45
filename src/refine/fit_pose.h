#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "refine/fit_model.h"

namespace retarget {

/// Where the links of a model are in one configuration, and how each degree of freedom moves what
/// it carries.
struct FitPose {
  explicit FitPose(const FitModel& model)
      : world_from_link(model.links.size()),
        linear(static_cast<std::size_t>(model.dof_count()), Eigen::Vector3d::Zero()),
        angular(static_cast<std::size_t>(model.dof_count()), Eigen::Vector3d::Zero()) {}

  std::vector<Frame> world_from_link;
  /// Velocity of the point of the carried body that is at the root's origin, and angular velocity,
  /// per unit of each degree of freedom, in the world.
  std::vector<Eigen::Vector3d> linear, angular;

  /// @param qpos  in the layout of Robot; a unit quaternion.
  void update(const FitModel& model, std::span<const double> qpos);
};

}  // namespace retarget
