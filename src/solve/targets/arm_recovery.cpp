#include "solve/targets/arm_recovery.h"

#include <algorithm>

#include "retarget/human.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

constexpr double kAstrayArm = 1.0471975511965976;  // 60 degrees.
constexpr double kBack = 0.87266462599716477;      // 50 degrees.
constexpr int kFirstWait = 4, kMaxWait = 256;      // Frames.

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
  if (max < kBack) {
    wait_ = 0;
    next_wait_ = kFirstWait;
  }
  if (!(max > kAstrayArm) || wait_-- > 0) return false;
  wait_ = next_wait_;
  next_wait_ = std::min(2 * next_wait_, kMaxWait);
  return true;
}

}  // namespace retarget
