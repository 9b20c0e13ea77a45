#include "solve/targets/frame_solver.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace retarget {
namespace {

// Largest position, metres; squares of it are far from overflow.
constexpr double kMaxPosition = 1e100;

bool all_finite(std::span<const Pose> poses) {
  return std::ranges::all_of(poses, [](const Pose& pose) {
    return pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
           pose.translation.cwiseAbs().maxCoeff() < kMaxPosition;
  });
}

std::string in_frame(int frame, std::string_view what) {
  return frame < 0 ? std::string(what) : fmt::format("frame {}: {}", frame, what);
}

}  // namespace

FrameSolver::FrameSolver(std::shared_ptr<const IkProblem> problem, IkEngine engine,
                         const IkOptions& options)
    : passes_(static_cast<int>(problem->passes.size())),
      solver_(engine == IkEngine::kFast ? make_fast_solver(std::move(problem), options)
                                        : make_reference_solver(std::move(problem), options)) {}

Result<SolvedFrame> FrameSolver::solve(std::span<const Pose> world_from_target,
                                       std::span<double> qpos, const std::string& config_file,
                                       int frame) {
  if (!all_finite(world_from_target)) {
    return input_failure({},
                         in_frame(frame, "the targets are not finite, or positions are too large"));
  }
  SolvedFrame result;
  for (int pass = 0; pass < passes_; ++pass) {
    const PassResult solved = solver_->solve_pass(pass, world_from_target, qpos);
    if (!solved.converged) {
      return config_failure(
          config_file,
          in_frame(frame, "these weights and scales lead to values that are not finite"));
    }
    result.steps += solved.steps;
    result.error = solved.errors[solved.steps];
  }
  return result;
}

}  // namespace retarget
