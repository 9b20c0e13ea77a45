#include "solve/fit/task_terms.h"

#include <algorithm>

#include "retarget/so3.h"
#include "solve/fit/shorthand.h"

namespace retarget {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d position_weights(const FitTask& task, const FrameGoals& goals) {
  const double lying = task.foot >= 0 ? 1.0 - goals.upright[at(task.foot)] : 1.0;
  const double horizontal = square(task.horizontal_weight);
  return {horizontal, horizontal, square(task.height_weight) * lying};
}

Vector3d rotation_error(const Pose& world_from_link, const TaskTarget& target) {
  return log_so3(world_from_link.rotation * target.world_from_link.conjugate());
}

RotationTerm rotation_term(const FitTask& task, const FrameGoals& goals,
                           const Pose& world_from_link, const TaskTarget& target) {
  constexpr double kLyingShare = 0.25;
  if (!task.follows_rotation()) return {};
  const bool may_lie = task.foot >= 0 && !goals.lying.empty();
  const double lying = may_lie ? goals.lying[at(task.foot)] : 0.0;
  const double share = 1.0 - (1.0 - kLyingShare) * lying;
  const double weight = square(share * task.rotation_weight);
  const Vector3d error = rotation_error(world_from_link, target);
  RotationTerm term{weight * error.squaredNorm(), weight * error, weight * Matrix3d::Identity()};
  const double twist_weight = target.twist_share * task.twist_weight;
  if (twist_weight == task.rotation_weight) return term;
  // The twist is the same along the target's axis a as along the link's. Its derivative is J^-T a
  // with the left Jacobian J of the error; the series is accurate to the sixth order.
  const double more = square(share * twist_weight) - weight;
  const Vector3d axis = target.world_from_link * task.twist_axis;
  const double twist = axis.dot(error);
  const Vector3d cross = error.cross(axis);
  const double second = (1.0 + error.squaredNorm() / 60.0) / 12.0;
  const Vector3d rate = axis + 0.5 * cross + second * error.cross(cross);
  term.cost += more * square(twist);
  term.gradient += (more * twist) * rate;
  // The rate grows beyond 1 with the error; the matrix must stay positive.
  term.hessian += (more / std::max(1.0, rate.squaredNorm()) * rate) * rate.transpose();
  return term;
}

}  // namespace retarget
