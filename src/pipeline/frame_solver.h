#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "ik/ik_solver.h"
#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// What all passes over one frame took.
struct SolvedFrame {
  int steps = 0;
  double error = 0.0;  ///< Unweighted norm after the last pass.
};

/// The passes of the published method over one frame: the step that clips and single frames share.
/// Allocates nothing per frame.
class FrameSolver {
 public:
  FrameSolver(std::shared_ptr<const IkProblem> problem, IkEngine engine, const IkOptions& options);

  /// Errors: positions too large to compute with (kInput, without a file); weights that lead to
  /// values that are not finite (kConfig).
  /// @param qpos         start and result, in the layout of RobotClip.
  /// @param config_file  for messages.
  /// @param frame        for messages; -1: a frame without a number.
  [[nodiscard]] Result<SolvedFrame> solve(std::span<const Pose> world_from_target,
                                          std::span<double> qpos, const std::string& config_file,
                                          int frame = -1);

 private:
  int passes_;
  std::unique_ptr<IkSolver> solver_;
};

}  // namespace retarget
