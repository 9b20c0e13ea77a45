#include "retarget/pipeline/retarget.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "retarget/base/suggest.h"
#include "retarget/pipeline/targets.h"

namespace retarget {
namespace {

// metres; squares of such numbers are still far from the end of a double
constexpr double kLargestPosition = 1e100;

// names the mapped bones that the source lacks, and what it has instead
Result<void> check_bones(const HumanClip& human, const TargetBuilder& targets,
                         const std::string& clip_name, const std::string& mapping) {
  std::vector<std::string> missing, present;
  for (const int bone : targets.bones()) {
    if (!human.has(bone)) missing.emplace_back(kBoneNames[bone]);
  }
  if (missing.empty()) return {};
  return input_failure(clip_name,
                       "the skeleton has no joint for " +
                           std::string(missing.size() == 1 ? "the bone " : "the bones ") +
                           list_names(missing) + ", which the mapping " + mapping + " uses",
                       "the file has " + list_names(human.source_joints));
}

bool all_finite(std::span<const Pose> poses) {
  return std::ranges::all_of(poses, [](const Pose& pose) {
    return pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
           pose.translation.cwiseAbs().maxCoeff() < kLargestPosition;
  });
}

void keep_quaternion_sign(std::span<const double> before, std::span<double> now) {
  constexpr int kRootRotation = 3;
  double dot = 0.0;
  for (int i = 0; i < 4; ++i) dot += before[kRootRotation + i] * now[kRootRotation + i];
  if (dot >= 0.0) return;
  for (int i = 0; i < 4; ++i) now[kRootRotation + i] = -now[kRootRotation + i];
}

}  // namespace

Result<RetargetResult> retarget(const HumanClip& human, const std::string& clip_name,
                                const std::shared_ptr<const Robot>& robot, const IkTables& tables,
                                const LimitSet& limits, const RetargetOptions& options) {
  if (auto checked = check_ik_tables(tables, *robot); !checked) return failure(checked.error());
  const TargetBuilder targets(tables, human.height);
  if (auto checked = check_bones(human, targets, clip_name, tables.file); !checked) {
    return failure(checked.error());
  }

  const auto problem = make_problem(robot, tables, targets, limits);
  const auto solver = options.engine == IkEngine::kFast
                          ? make_fast_solver(problem, options.ik)
                          : make_reference_solver(problem, options.ik);

  RetargetResult result;
  result.clip = RobotClip(robot, human.rate, human.frame_count);
  std::vector<double> qpos = robot->zero_configuration();
  std::vector<Pose> world_from_target(targets.target_count());
  for (int frame = 0; frame < human.frame_count; ++frame) {
    if (options.keep_going && !options.keep_going(frame)) return interrupted_failure();
    targets.build(human.frame(frame), world_from_target);
    if (!all_finite(world_from_target)) {
      return input_failure(clip_name, "frame " + std::to_string(frame) +
                                          ": positions are too large to compute with");
    }
    int steps = 0;
    double error = 0.0;
    for (std::size_t pass = 0; pass < problem->passes.size(); ++pass) {
      const PassResult solved = solver->solve_pass(static_cast<int>(pass), world_from_target, qpos);
      if (!solved.converged) {
        return config_failure(tables.file, "frame " + std::to_string(frame) +
                                               ": these weights and scales lead to values that "
                                               "are not finite");
      }
      steps += solved.steps;
      error = solved.errors[solved.steps];
    }
    if (frame > 0) keep_quaternion_sign(result.clip.qpos(frame - 1), qpos);
    std::ranges::copy(qpos, result.clip.qpos(frame).begin());
    result.steps += steps;
    result.most_steps = std::max(result.most_steps, steps);
    result.mean_error += error / human.frame_count;
  }
  return result;
}

}  // namespace retarget
