#include "solve/online/online_targets.h"

#include <algorithm>
#include <utility>

#include "retarget/try.h"
#include "solve/ik/ik_solver.h"
#include "solve/targets/limb_lengths.h"
#include "solve/targets/solve_frames.h"

namespace retarget {

Result<std::unique_ptr<OnlineTargets>> OnlineTargets::make(const Plan& plan) {
  HumanPoser poser(*plan.clip, plan.human.calibration);
  const HumanClipInfo human = poser.info();
  const bool as_fit = plan.options.solve.method == Method::kFit;
  RETARGET_TRY_ASSIGN(TargetBuilder targets,
                      make_targets(human, poses_of(poser), *plan.robot.robot, plan.config,
                                   plan.scale, as_fit ? TrunkRule::kLines : TrunkRule::kBones,
                                   as_fit ? &plan.limits : nullptr));
  return std::unique_ptr<OnlineTargets>(new OnlineTargets(plan, human, std::move(targets)));
}

OnlineTargets::OnlineTargets(const Plan& plan, const HumanClipInfo& human, TargetBuilder targets)
    : as_fit_(plan.options.solve.method == Method::kFit),
      engine_(plan.options.solve.engine),
      robot_(plan.robot.robot),
      config_(plan.config),
      limits_(plan.limits),
      solver_limits_(as_fit_ ? first_limits(*robot_, limits_) : limits_),
      human_(human),
      targets_(std::move(targets)),
      options_(options_for(*plan.robot.robot, plan.fit)),
      solver_(make_problem(robot_, config_, targets_, solver_limits_), engine_, IkOptions()),
      world_from_target_(static_cast<std::size_t>(targets_.target_count())),
      qpos_(robot_->zero_configuration()),
      before_(qpos_),
      settles_(as_fit_) {
  const auto limbs = robot_limbs(*robot_, config_);
  if (limbs) options_ = sized_options(options_, limbs->lengths.leg);
  // Dynamics need future frames, which a stream does not have.
  options_.dynamics = false;
  BoneArray<int> target_of_bone;
  for (const Bone bone : kAllBones) target_of_bone[bone] = targets_.target_of(bone);
  model_ =
      make_fit_model(*robot_, config_, limits_, target_of_bone, options_, sides_with_feet(human_));
  if (limbs) model_.leg = limbs->lengths.leg;
  scales_ = path_scales(targets_);
}

void OnlineTargets::build(const HumanPose& world_from_bone) {
  targets_.build(world_from_bone, world_from_target_);
  if (!as_fit_) return;
  path_ = (scales_.foot - scales_.root) * world_from_bone[config_.root_bone].translation;
}

bool OnlineTargets::solve() {
  std::ranges::copy(qpos_, before_.begin());
  const bool solved = std::exchange(settles_, false)
                          ? settle()
                          : solver_.solve(world_from_target_, qpos_, config_.file).has_value();
  if (!solved) std::ranges::copy(before_, qpos_.begin());
  return solved;
}

bool OnlineTargets::settle() {
  const MadeTargets made{targets_, FrameRate{}, world_from_target_};
  SolveFramesOptions options;
  options.engine = engine_;
  options.settle = true;
  const auto solved = solve_frames(made, robot_, config_, solver_limits_, options);
  if (!solved) return false;
  std::ranges::copy(solved->clip.qpos(0), qpos_.begin());
  return true;
}

}  // namespace retarget
