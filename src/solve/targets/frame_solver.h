#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "solve/ik/ik_solver.h"
#include "solve/targets/targets.h"

namespace retarget {

/// Result of all passes over one frame.
struct SolvedFrame {
  int steps = 0;       ///< IK steps of all passes.
  double error = 0.0;  ///< Unweighted error norm after the last pass.
};

/// Runs all passes of the published method over one frame. Does not allocate per frame.
class FrameSolver {
 public:
  FrameSolver(std::shared_ptr<const IkProblem> problem, IkEngine engine, const IkOptions& options);

  /// Errors: targets that are not finite or too large for the computation (kInput, without a file
  /// name); weights that lead to non-finite values (kConfig).
  /// @param world_from_target  one pose per target, metres.
  /// @param qpos               start, then result; laid out as in RobotClip.
  /// @param config_file        name of the configuration for messages.
  /// @param frame              frame number for messages; -1: without a frame number.
  [[nodiscard]] Result<SolvedFrame> solve(std::span<const Pose> world_from_target,
                                          std::span<double> qpos, const std::string& config_file,
                                          int frame = -1);

 private:
  int passes_;
  std::unique_ptr<IkSolver> solver_;
};

/// Detects arms on a wrong branch of their inverse kinematics. A shoulder reaches most poses on two
/// branches. A frame-by-frame solver that enters the wrong one while the arm is straight reaches a
/// joint limit and stays there.
class ArmRecovery {
 public:
  ArmRecovery(const IkProblem& problem, const TargetBuilder& targets);

  /// Call it for each frame in order.
  /// @param qpos  solved configuration of the frame.
  /// @return whether an upper arm has a rotation error of more than 60 degrees and a search for
  ///     another configuration is due. While the error persists, the number of frames until the
  ///     next search doubles, up to 256.
  [[nodiscard]] bool seen(std::span<const double> qpos, std::span<const Pose> world_from_target);

 private:
  const Robot& robot_;
  std::vector<FrameTask> arms_;
  std::vector<Pose> world_from_body_;
  int wait_ = 0;  // Frames until the next search.
  int next_wait_;
};

}  // namespace retarget
