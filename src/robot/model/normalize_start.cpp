#include "retarget/normalize_start.h"

#include "retarget/so3.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

// Below this horizontal length of the unit x axis, the axis is too steep to define a heading.
constexpr double kSteep = 0.1;

Eigen::Quaterniond rotation_of(std::span<const double> qpos) {
  return {qpos[3], qpos[4], qpos[5], qpos[6]};
}

}  // namespace

double heading(const Eigen::Quaterniond& world_from_body) {
  const Eigen::Vector3d x = world_from_body * Eigen::Vector3d::UnitX();
  if (x.head<2>().norm() > kSteep) return portable::atan2(x.y(), x.x());
  return 2.0 * portable::atan2(world_from_body.z(), world_from_body.w());
}

StartNormalizer::StartNormalizer(std::span<const double> first)
    : origin_(first[0], first[1], 0.0),
      turn_(exp_so3(-heading(rotation_of(first)) * Eigen::Vector3d::UnitZ())) {}

void StartNormalizer::apply(std::span<double> qpos) const {
  const Eigen::Vector3d position = turn_ * (Eigen::Vector3d(qpos[0], qpos[1], qpos[2]) - origin_);
  const Eigen::Quaterniond rotation = turn_ * rotation_of(qpos);
  for (int i = 0; i < 3; ++i) qpos[i] = position[i];
  qpos[3] = rotation.w();
  for (int i = 0; i < 3; ++i) qpos[4 + i] = rotation.vec()[i];
}

void normalize_start(RobotClip& clip) {
  if (clip.frame_count() == 0) return;
  const StartNormalizer normalizer(clip.qpos(0));
  for (int frame = 0; frame < clip.frame_count(); ++frame) normalizer.apply(clip.qpos(frame));
}

}  // namespace retarget
