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
  int steps = 0;
  double error = 0.0;  ///< Unweighted error norm after the last pass.
};

/// Runs the passes of the published method over one frame; shared by clips and single frames. Does
/// not allocate per frame.
class FrameSolver {
 public:
  FrameSolver(std::shared_ptr<const IkProblem> problem, IkEngine engine, const IkOptions& options);

  /// Errors: positions too large to compute with (kInput, without a file name); weights that lead
  /// to non-finite values (kConfig).
  /// @param qpos         start and result, in the layout of RobotClip.
  /// @param config_file  for messages.
  /// @param frame        frame number for messages; -1 if there is none.
  [[nodiscard]] Result<SolvedFrame> solve(std::span<const Pose> world_from_target,
                                          std::span<double> qpos, const std::string& config_file,
                                          int frame = -1);

 private:
  int passes_;
  std::unique_ptr<IkSolver> solver_;
};

/// Detects arms on a wrong branch. A shoulder reaches most poses in two ways; a frame-by-frame
/// solver that takes the wrong one while an arm is stretched runs into joint limits and stays
/// there.
class ArmRecovery {
 public:
  ArmRecovery(const IkProblem& problem, const TargetBuilder& targets);

  /// @return true if an upper arm is more than 60 degrees off its target and a search for another
  ///     configuration is due. While the arm stays off target, the number of frames until the next
  ///     search doubles, up to 256.
  /// @param qpos  solved configuration of the frame.
  [[nodiscard]] bool seen(std::span<const double> qpos, std::span<const Pose> world_from_target);

 private:
  const Robot& robot_;
  std::vector<FrameTask> arms_;
  std::vector<Pose> world_from_body_;
  int wait_ = 0;  // Frames until the next search.
  int next_wait_;
};

}  // namespace retarget
