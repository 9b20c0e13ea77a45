#include "solve/targets/frame_solver.h"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "retarget/human.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

// Largest position whose squares are far from an overflow, metres.
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

namespace {

constexpr double kAstrayArm = 1.0471975511965976;   // 60 degrees.
constexpr double kRecovered = 0.87266462599716477;  // 50 degrees.
constexpr int kFirstWait = 4, kMaxWait = 256;       // Frames between two searches.

}  // namespace

ArmRecovery::ArmRecovery(const IkProblem& problem, const TargetBuilder& targets)
    : robot_(*problem.robot),
      world_from_body_(problem.robot->bodies().size()),
      next_wait_(kFirstWait) {
  if (problem.passes.empty()) return;
  for (const Bone bone : {Bone::kLeftArm, Bone::kRightArm}) {
    const int target = targets.target_of(bone);
    for (const FrameTask& task : problem.passes.back()) {
      if (target >= 0 && task.target == target && task.rotation_weight > 0.0) {
        arms_.push_back(task);
      }
    }
  }
}

bool ArmRecovery::seen(std::span<const double> qpos, std::span<const Pose> world_from_target) {
  if (arms_.empty()) return false;
  forward_kinematics(robot_, qpos, world_from_body_);
  double max = 0.0;
  for (const FrameTask& task : arms_) {
    const Eigen::Quaterniond& body = world_from_body_[static_cast<std::size_t>(task.body)].rotation;
    const Eigen::Quaterniond& target =
        world_from_target[static_cast<std::size_t>(task.target)].rotation;
    max = std::max(max, log_so3(body.conjugate() * target).norm());
  }
  if (max < kRecovered) {
    wait_ = 0;
    next_wait_ = kFirstWait;
  }
  if (!(max > kAstrayArm) || wait_-- > 0) return false;
  wait_ = next_wait_;
  next_wait_ = std::min(2 * next_wait_, kMaxWait);
  return true;
}

}  // namespace retarget
