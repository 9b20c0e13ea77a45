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

/// Wants the frame of a robot body at the pose of a target.
struct FrameTask {
  int body = 0;                  ///< Index of the robot body.
  int target = 0;                ///< Index into the targets of a frame.
  double position_weight = 0.0;  ///< Per metre; enters the objective squared.
  double rotation_weight = 0.0;  ///< Per radian; enters the objective squared.
};

/// The tasks that are solved together; the passes of a frame are solved one after the other.
using IkPass = std::vector<FrameTask>;

/// What is to be solved for every frame. Immutable; shared by the solvers of all threads.
struct IkProblem {
  std::shared_ptr<const Robot> robot;
  std::vector<IkPass> passes;
  /// Range of each hinge and slide joint, in the robot's joint order (rad, m); -+infinity where a
  /// joint is not limited. lower <= upper.
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

/// Constants of the published two-pass method.
struct IkOptions {
  double damping = 0.5;        ///< On the diagonal of H for every degree of freedom.
  double lm_damping = 1.0;     ///< Adds this times |weighted error|^2 of each task to the diagonal.
  double limit_gain = 0.95;    ///< Share of the way to a joint limit that one step may take.
  double min_progress = 1e-3;  ///< A pass goes on while a step lowers its error by more than this.
  int max_extra_steps = 10;    ///< Steps of a pass after the first one, at most kMaxExtraSteps.
};

inline constexpr int kMaxExtraSteps = 30;

/// What one pass over one frame did.
struct PassResult {
  int steps = 0;
  /// Norm of the stacked six-vector errors of all tasks, without weights, before the first step
  /// and after each: steps + 1 values.
  std::array<double, kMaxExtraSteps + 2> errors{};
  bool converged = true;  ///< False where a QP could not be solved: values not finite.
};

/// Differential inverse kinematics of one frame at a time: each pass takes damped Gauss-Newton
/// steps inside the joint limits until the error stops falling (docs/ik.md).
///
/// One solver belongs to one thread; it owns its scratch memory and allocates nothing in solve.
class IkSolver {
 public:
  virtual ~IkSolver() = default;

  /// Solves one pass, warm-started.
  /// @param targets  world_from_target of every target of the frame, metres.
  /// @param qpos     configuration in the layout of RobotClip; start and result.
  virtual PassResult solve_pass(int pass, std::span<const Pose> targets,
                                std::span<double> qpos) = 0;
};

/// A box QP that a solver met and its solution; see BoxQp. Valid during the call alone.
struct QpRecord {
  const Eigen::MatrixXd& H;
  const Eigen::VectorXd& g;
  const Eigen::VectorXd& lower;
  const Eigen::VectorXd& upper;
  const Eigen::VectorXd& x;
};

/// The engine to read and to hold others against: MuJoCo's kinematics and Jacobians, dense
/// matrices, nothing exploited.
/// @param observe  sees every QP after it is solved; for tests and studies.
[[nodiscard]] std::unique_ptr<IkSolver> make_reference_solver(
    std::shared_ptr<const IkProblem> problem, const IkOptions& options = {},
    std::function<void(const QpRecord&)> observe = {});

/// The engine to use: forward kinematics of what carries a task alone, one logarithm per task,
/// task terms composed up the tree instead of stacked Jacobians, a factorisation that keeps the
/// tree's sparsity. Agrees with the reference engine to 1e-9 a frame from the same start.
[[nodiscard]] std::unique_ptr<IkSolver> make_fast_solver(std::shared_ptr<const IkProblem> problem,
                                                         const IkOptions& options = {});

}  // namespace retarget
