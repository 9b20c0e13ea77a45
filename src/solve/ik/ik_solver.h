#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "retarget/pose.h"
#include "retarget/robot.h"

namespace retarget {

/// A task that moves the frame of a robot body to the pose of a target.
struct FrameTask {
  int body = 0;                  ///< Index of the robot body.
  int target = 0;                ///< Index into the targets of a frame.
  double position_weight = 0.0;  ///< Weight per metre; enters the objective squared.
  double rotation_weight = 0.0;  ///< Weight per radian; enters the objective squared.
};

/// The tasks of one pass, which form one least-squares problem. A frame runs its passes in
/// sequence.
using IkPass = std::vector<FrameTask>;

/// The problem of every frame. Constant, so that solvers of several threads can share it.
struct IkProblem {
  std::shared_ptr<const Robot> robot;
  std::vector<IkPass> passes;
  /// Range of each hinge and slide joint, in the robot's joint order (rad, m); -+infinity if
  /// unlimited. lower <= upper.
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

/// Constants of the published two-pass method.
struct IkOptions {
  double damping = 0.5;      ///< Added to the diagonal of H for every degree of freedom.
  double lm_damping = 1.0;   ///< Factor of |weighted error|^2 of every task, which is added to the
                             ///< diagonal of H (Levenberg-Marquardt).
  double limit_gain = 0.95;  ///< Share of the distance to a joint limit that a step may cover.
  double min_progress = 1e-3;  ///< Smallest error reduction of a step after which a pass continues.
  int max_extra_steps = 10;    ///< Maximum number of steps of a pass after the first one, at most
                               ///< kMaxExtraSteps.
};

/// Upper bound of IkOptions::max_extra_steps.
inline constexpr int kMaxExtraSteps = 30;

/// Result of one pass over one frame.
struct PassResult {
  int steps = 0;  ///< Number of steps.
  /// Norm of the stacked, unweighted six-vector errors of all tasks before the first step and after
  /// each step: steps + 1 values.
  std::array<double, kMaxExtraSteps + 2> errors{};
  bool converged = true;  ///< False if a QP had no solution or an error was not finite.
};

/// Differential inverse kinematics of single frames. Each pass takes damped Gauss-Newton steps
/// inside the joint limits until the error stops decreasing (docs/ik.md).
///
/// A solver belongs to one thread, owns its scratch memory, and does not allocate while solving.
class IkSolver {
 public:
  virtual ~IkSolver() = default;

  /// Solves one pass, starting from `qpos`.
  /// @param pass     index into IkProblem::passes.
  /// @param targets  world_from_target of all targets of the frame, metres.
  /// @param qpos     start, then result; laid out as in RobotClip.
  virtual PassResult solve_pass(int pass, std::span<const Pose> targets,
                                std::span<double> qpos) = 0;
};

/// A box QP and its solution; see BoxQp. Valid only during the call.
struct QpRecord {
  const Eigen::MatrixXd& H;
  const Eigen::VectorXd& g;
  const Eigen::VectorXd& lower;
  const Eigen::VectorXd& upper;
  const Eigen::VectorXd& x;
};

/// Makes the reference engine, a readable implementation for comparisons. It uses MuJoCo's
/// kinematics and Jacobians and dense matrices.
/// @param observe  called with every solved QP, for tests and studies.
[[nodiscard]] std::unique_ptr<IkSolver> make_reference_solver(
    std::shared_ptr<const IkProblem> problem, const IkOptions& options = {},
    std::function<void(const QpRecord&)> observe = {});

/// Makes the default engine. It computes forward kinematics only for links that carry a task and
/// one logarithm per task, accumulates task terms from the leaves to the root of the tree instead
/// of stacking Jacobians, and factorises with the sparsity of the tree. From the same start, it
/// agrees with the reference engine to 1e-9 per frame.
[[nodiscard]] std::unique_ptr<IkSolver> make_fast_solver(std::shared_ptr<const IkProblem> problem,
                                                         const IkOptions& options = {});

}  // namespace retarget
