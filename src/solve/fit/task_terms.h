#pragma once

#include <Eigen/Core>

#include "retarget/pose.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/frame_terms.h"

namespace retarget {

/// Squared weights of a task's position error along the world axes. For an upright foot, the weight
/// of the height is 0: the clearances of heel and toe determine it.
[[nodiscard]] Eigen::Vector3d position_weights(const FitTask& task, const FrameGoals& goals);
/// Rotation vector from the target rotation of a link to its current rotation, world axes, radians.
[[nodiscard]] Eigen::Vector3d rotation_error(const Pose& world_from_link, const TaskTarget& target);

/// The squared, weighted rotation error of a task.
struct RotationTerm {
  double cost = 0.0;
  /// Derivatives of half the cost with respect to a rotation of the link, world axes.
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();  ///< Gauss-Newton.
};
/// The term of a task. Its weight is smaller for a lying foot, whose rotation the floor determines:
/// few ankles reach the human's rotation, and the error would lift the knees off the floor.
[[nodiscard]] RotationTerm rotation_term(const FitTask& task, const FrameGoals& goals,
                                         const Pose& world_from_link, const TaskTarget& target);

}  // namespace retarget
