#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "retarget/error.h"
#include "retarget/options.h"
#include "solve/ik/ik_solver.h"

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

}  // namespace retarget
