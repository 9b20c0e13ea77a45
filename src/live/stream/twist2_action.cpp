#include "live/stream/twist2_action.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "retarget/so3.h"
#include "retarget/trigonometry.h"
#include "retarget/try.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

double roll_of(const Quaterniond& q) {
  return atan2(2.0 * (q.w() * q.x() + q.y() * q.z()), 1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y()));
}

double pitch_of(const Quaterniond& q) {
  const double sine = std::clamp(2.0 * (q.w() * q.y() - q.z() * q.x()), -1.0, 1.0);
  return atan2(sine, std::sqrt((1.0 - sine) * (1.0 + sine)));
}

void copy_hand(const std::optional<std::array<std::size_t, kDex3Motors>>& joints,
               std::span<const double> qpos, std::array<double, kDex3Motors>& hand) {
  for (std::size_t i = 0; joints && i < hand.size(); ++i) hand[i] = qpos[(*joints)[i]];
}

}  // namespace

Result<Twist2Actions> Twist2Actions::make(const Robot& robot, double fps) {
  Twist2Actions made;
  RETARGET_TRY_ASSIGN(made.joints_, find_g1_joints(robot, "TWIST2"));
  made.fps_ = fps;
  return made;
}

const Twist2Action& Twist2Actions::take(const RobotFrame& frame) {
  const auto qpos = frame.qpos;
  const Root root = {frame.index, Vector3d(qpos[0], qpos[1], qpos[2]),
                     Quaterniond(qpos[3], qpos[4], qpos[5], qpos[6]).normalized()};
  // Frames of another session have no history.
  if (!previous_ || root.index != previous_->index + 1) previous_ = root;
  const Quaterniond root_from_world = root.world_from_root.conjugate();
  const Vector3d velocity = fps_ * (root_from_world * (root.position - previous_->position));
  const Vector3d turn = log_so3(root.world_from_root * previous_->world_from_root.conjugate());
  const Vector3d turning_rate = fps_ * (root_from_world * turn);
  action_.body[0] = velocity.x();
  action_.body[1] = velocity.y();
  action_.body[2] = root.position.z();
  action_.body[3] = roll_of(root.world_from_root);
  action_.body[4] = pitch_of(root.world_from_root);
  action_.body[5] = turning_rate.z();
  for (std::size_t i = 0; i < kG1Joints; ++i) action_.body[6 + i] = qpos[joints_.mujoco[i]];
  copy_hand(joints_.left_hand, qpos, action_.left_hand);
  copy_hand(joints_.right_hand, qpos, action_.right_hand);
  previous_ = root;
  return action_;
}

}  // namespace retarget
