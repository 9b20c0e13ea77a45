#include "live/session/standing_pose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "retarget/pose.h"

namespace retarget {

StandingPose::StandingPose(const Robot& robot, const LimitSet& limits)
    : qpos_(robot.zero_configuration()) {
  for (std::size_t joint = 0; joint < robot.joints().size(); ++joint) {
    double& value = qpos_[static_cast<std::size_t>(robot.joints()[joint].qpos_address)];
    value = std::clamp(value, limits.lower[joint], limits.upper[joint]);
  }
  stands_fast_ = robot.fixed_base();
  if (stands_fast_) return;
  std::ranges::fill_n(qpos_.begin(), 7, 0.0);
  qpos_[3] = 1.0;
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, qpos_, world_from_body);
  double lowest = HUGE_VAL;
  for (const Sole& sole : robot.profile().soles) {
    for (const Eigen::Vector3d& point : sole.points) {
      lowest = std::min(lowest, (world_from_body[static_cast<std::size_t>(sole.body)] * point).z());
    }
  }
  // Without soles, use the lowest body origin.
  if (lowest == HUGE_VAL) {
    for (std::size_t body = 1; body < world_from_body.size(); ++body) {
      lowest = std::min(lowest, world_from_body[body].translation.z());
    }
  }
  qpos_[2] = -lowest;
}

void StandingPose::place(std::span<const double> qpos) {
  if (stands_fast_) return;
  qpos_[0] = qpos[0];
  qpos_[1] = qpos[1];
  // Keep only the rotation about the vertical.
  const double norm = std::sqrt(qpos[3] * qpos[3] + qpos[6] * qpos[6]);
  constexpr double kTurned = 1e-6;
  qpos_[3] = norm > kTurned ? qpos[3] / norm : 1.0;
  qpos_[4] = qpos_[5] = 0.0;
  qpos_[6] = norm > kTurned ? qpos[6] / norm : 0.0;
}

}  // namespace retarget
