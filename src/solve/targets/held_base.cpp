#include "solve/targets/held_base.h"

#include <cmath>
#include <utility>
#include <vector>

#include "retarget/human_skeleton.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

// The rotation about the vertical contained in a rotation; identity if the rotation turns upside
// down.
Eigen::Quaterniond heading_of(const Eigen::Quaterniond& rotation) {
  constexpr double kTurned = 1e-9;
  const double norm = std::sqrt(rotation.w() * rotation.w() + rotation.z() * rotation.z());
  if (!(norm > kTurned)) return Eigen::Quaterniond::Identity();
  return {rotation.w() / norm, 0.0, 0.0, rotation.z() / norm};
}

}  // namespace

HeldBase::HeldBase(const Robot& robot, const ResolvedConfig& config) : root_(config.root_bone) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, robot.zero_configuration(), world_from_body);
  const Pose& base = world_from_body[static_cast<std::size_t>(config.root_body)];
  place_ = base.translation;
  const Eigen::Quaterniond standing(canonical_t_pose(root_));
  standing_from_root_ = standing.conjugate();
  const ConfigTask* task = config.find_task(root_);
  const Eigen::Quaterniond offset =
      task == nullptr ? Eigen::Quaterniond::Identity() : task->rotation_offset;
  base_from_standing_ = (base.rotation * (standing * offset).conjugate()).normalized();
}

Eigen::Quaterniond HeldBase::turn(const HumanPose& world_from_bone) const {
  const Eigen::Quaterniond turned =
      (world_from_bone[root_].rotation * standing_from_root_).normalized();
  const Eigen::Quaterniond frame = root_ == Bone::kHips ? heading_of(turned) : turned;
  return (base_from_standing_ * frame.conjugate()).normalized();
}

std::optional<HeldBase> held_base(const Robot& robot, const ResolvedConfig& config) {
  if (!robot.fixed_base()) return std::nullopt;
  return HeldBase(robot, config);
}

HumanClip seen_by(const HeldBase& base, Bone root, HumanClip human) {
  for (HumanPose& pose : human.world_from_bone) {
    const Eigen::Quaterniond turn = base.turn(pose);
    const Eigen::Vector3d from = pose[root].translation;
    for (const Bone bone : kAllBones) {
      pose[bone] = {(turn * pose[bone].rotation).normalized(),
                    base.place() + turn * (pose[bone].translation - from)};
    }
  }
  return human;
}

}  // namespace retarget
