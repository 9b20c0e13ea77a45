#include "live/motion_limiter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "math/so3.h"
#include "robot/kinematic_tree.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// of the root, faster than any human's by the size of a robot
constexpr double kRootSpeed = 8.0, kRootTurnRate = 15.0;  // m/s, rad/s
// after an interruption: at once, and gained every second
constexpr double kFirstRootSpeed = 0.2, kMoreRootSpeed = 1.5;
constexpr double kFirstTurnRate = 0.5, kMoreTurnRate = 3.0;
constexpr double kFirstJointSpeed = 0.5, kMoreJointSpeed = 4.0;
constexpr double kFirstSlideSpeed = 0.05, kMoreSlideSpeed = 0.4;
constexpr double kMinSlowTime = 0.3;  // seconds
// limits hold for numbers with six digits, too
constexpr double kPrinted = 1.1e-6;

}  // namespace

MotionLimiter::MotionLimiter(const Robot& robot, const LimitSet& limits, const FitOptions& options)
    : max_joint_step_(options.max_joint_step),
      now_(static_cast<std::size_t>(robot.configuration_size()), 0.0) {
  const auto& links = robot.tree().links();
  for (std::size_t link = 1; link < links.size(); ++link) {
    const auto joint = static_cast<std::size_t>(links[link].joint);
    const double own = robot.speed_limit(links[link].joint);
    joints_.push_back({static_cast<std::size_t>(links[link].qpos_address), limits.lower[joint],
                       limits.upper[joint],
                       links[link].slides ? own : std::min(own, options.max_joint_speed),
                       links[link].slides});
  }
}

void MotionLimiter::reset() {
  begun_ = false;
  since_interruption_ = -1.0;
}

void MotionLimiter::take(std::span<const double> wanted) {
  const Eigen::Vector4d before = Eigen::Map<const Eigen::Vector4d>(now_.data() + 3);
  std::ranges::copy(wanted, now_.begin());
  if (begun_) align_sign(before, Eigen::Map<Eigen::Vector4d>(now_.data() + 3));
  begun_ = true;
}

bool MotionLimiter::follow(std::span<const double> wanted, double seconds) {
  if (!begun_) {
    take(wanted);
    since_interruption_ = -1.0;
    return false;
  }
  const bool slow = since_interruption_ >= 0.0;
  if (slow) since_interruption_ += seconds;
  bool limited = follow_root(wanted, seconds);
  for (const JointRow& joint : joints_) {
    double speed = joint.speed;
    if (slow) {
      speed =
          std::min(speed, joint.slides ? kFirstSlideSpeed + kMoreSlideSpeed * since_interruption_
                                       : kFirstJointSpeed + kMoreJointSpeed * since_interruption_);
    }
    double step = speed * seconds;
    if (!joint.slides) step = std::min(step, max_joint_step_);
    step = std::max(step - kPrinted, 0.5 * step);
    double& now = now_[joint.address];
    const double goal = std::clamp(wanted[joint.address], joint.lower, joint.upper);
    const double next = std::clamp(goal, now - step, now + step);
    limited = limited || next != goal;
    now = next;
  }
  if (slow && !limited && since_interruption_ > kMinSlowTime) since_interruption_ = -1.0;
  return limited;
}

bool MotionLimiter::follow_root(std::span<const double> wanted, double seconds) {
  double speed = kRootSpeed, turn_rate = kRootTurnRate;
  if (since_interruption_ >= 0.0) {
    speed = std::min(speed, kFirstRootSpeed + kMoreRootSpeed * since_interruption_);
    turn_rate = std::min(turn_rate, kFirstTurnRate + kMoreTurnRate * since_interruption_);
  }
  bool limited = false;
  Eigen::Map<Vector3d> position(now_.data());
  const Vector3d way = Eigen::Map<const Vector3d>(wanted.data()) - position;
  if (const double length = way.norm(); length > speed * seconds) {
    position += way * (speed * seconds / length);
    limited = true;
  } else {
    position = Eigen::Map<const Vector3d>(wanted.data());
  }
  Eigen::Map<Eigen::Vector4d> rotation(now_.data() + 3);
  const Eigen::Vector4d before = rotation;
  const Quaterniond from(before[0], before[1], before[2], before[3]);
  const Quaterniond to(wanted[3], wanted[4], wanted[5], wanted[6]);
  const Vector3d turn = log_so3(from.conjugate() * to);
  if (const double angle = turn.norm(); angle > turn_rate * seconds) {
    const Quaterniond next = (from * exp_so3(turn * (turn_rate * seconds / angle))).normalized();
    rotation << next.w(), next.x(), next.y(), next.z();
    limited = true;
  } else {
    rotation = Eigen::Map<const Eigen::Vector4d>(wanted.data() + 3);
  }
  align_sign(before, rotation);
  return limited;
}

}  // namespace retarget
