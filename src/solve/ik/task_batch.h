#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "retarget/pose.h"
#include "robot/model/composite.h"

namespace retarget {

/// Errors of frame tasks and the quadratic forms of their squares, for four tasks per vector.
///
/// With the error twist e = log(T_wb^-1 T_wt) = [e_v; w] of the published method and A = J_l^-1(w)
/// on SO(3) (which is also the V^-1 of the logarithm), the inverse left Jacobian of SE(3) is
///   [[A, -A Q A], [0, A]].
/// A rotation of e from body to world axes changes neither norms nor A'A, so all quantities are in
/// world axes (docs/ik.md). The closed forms are those of published_jacobian_inverse(), also at
/// small angles, where digits cancel: the same expressions of the same values lose the same digits,
/// so that both engines agree.
///
/// Tasks are numbered from 0. Does not allocate after construction.
class TaskBatch {
 public:
  /// Squared weights of every task in one pass; 0 for tasks of other passes.
  struct Weights {
    std::vector<double> position, rotation;
  };

  TaskBatch() = default;
  /// @param link_from_body  one per task: the constant pose of its body in the link that carries
  ///   it.
  explicit TaskBatch(std::span<const Pose> link_from_body);

  /// Weights of 0, in the size that build_forms() expects.
  [[nodiscard]] Weights zero_weights() const;

  void set_target(int task, const Pose& world_from_target);
  void set_link(int task, const Pose& world_from_link);

  /// Computes the errors of all tasks.
  /// @param origin  the base's origin in the world, about which the forms are built.
  void measure(const Eigen::Vector3d& origin);
  /// Squared norm of a task's unweighted error.
  [[nodiscard]] double squared_error(int task) const { return value(kSquaredError, task); }
  /// Squared norm of a task's weighted error.
  [[nodiscard]] double weighted_error(int task, const Weights& weights) const {
    return weights.position[task] * value(kSquaredLinear, task) +
           weights.rotation[task] * value(kSquaredAngle, task);
  }

  /// Computes |W (J V + e)|^2 / 2 of all tasks, where V is the motion of the link.
  void build_forms(const Weights& weights);
  /// Adds the form of a task to the composite of its link.
  void add_form(int task, Composite& composite) const;

  /// The quantities of a task. Symmetric 3x3 matrices have the entries xx, yx, zx, yy, zy, zz;
  /// other matrices have nine, column by column.
  enum Row : int {
    kLink,                   // Pose of the link in the world: rotation x y z w, translation.
    kBody = kLink + 7,       // Pose of the body in the link.
    kTarget = kBody + 7,     // Pose of the target in the world.
    kLever = kTarget + 7,    // From the base's origin to the body, world axes.
    kLinear = kLever + 3,    // The linear part e_v of the error, metres.
    kAngular = kLinear + 3,  // The rotation vector w, radians.
    kSquaredAngle = kAngular + 3,
    kHalfSine,  // Sine of half the angle, from the quaternion.
    kHalfCosine,
    kSquaredLinear,
    kSquaredError,
    kFormLinear,  // As in Composite.
    kFormMixed = kFormLinear + 6,
    kFormAngular = kFormMixed + 9,
    kForce = kFormAngular + 6,
    kTorque = kForce + 3,
    kRowCount = kTorque + 3
  };
  static constexpr int kLanes = 4;
  /// Four tasks: the rows one after the other, at constant distances, so that loops over the tasks
  /// vectorise.
  using Block = std::array<double, static_cast<std::size_t>(kRowCount) * kLanes>;

 private:
  [[nodiscard]] double value(int row, int task) const {
    return blocks_[task / kLanes][row * kLanes + task % kLanes];
  }
  void set_pose(int first_row, int task, const Pose& pose);

  std::vector<Block> blocks_;
};

}  // namespace retarget
