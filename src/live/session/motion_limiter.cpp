#include "live/session/motion_limiter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "retarget/kinematic_tree.h"
#include "retarget/pose.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// For prismatic joints: first speed as a fraction of the full speed.
constexpr double kFirstSlideShare = 0.2;
// Acceleration limit for speeding up right after an interruption, as a fraction of the full one.
constexpr double kFirstAcceleration = 0.05;
// Margin that keeps steps within the limits after rounding to six decimals, as in written files.
constexpr double kPrintedDigits = 1.1e-6;
// Lower bound on a shortened step, as a fraction of the step; shorter steps never round up as much.
constexpr double kPrintedShare = 0.5;

double below_printed(double step) {
  return std::max(step - kPrintedDigits, kPrintedShare * step);
}

Vector3d shortened(Vector3d vector, double most) {
  if (const double length = vector.norm(); length > most) vector *= most / length;
  return vector;
}

// Maximum speed towards a limit such that the joint can stop at the limit, whatever durations the
// later steps have: it brakes from the middle of this step.
double last_braking_speed(double distance, double acceleration, double seconds) {
  if (distance <= 0.0) return 0.0;
  const double half = 0.5 * acceleration * seconds;
  return std::max(std::sqrt(2.0 * acceleration * distance) - half,
                  std::min(distance / seconds, half));
}

// Maximum speed towards a limit at the given distance, such that the joint stops at the limit if
// steps are even: either by braking after the next step, or in one step right after this one.
double braking_speed(double distance, double acceleration, double seconds, double shortest) {
  if (distance <= 0.0) return 0.0;
  const double braked =
      acceleration * (std::sqrt(seconds * seconds + 2.0 * distance / acceleration) - seconds);
  return std::max(braked, std::min(distance / seconds, acceleration * shortest));
}

}  // namespace

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

MotionLimiter::MotionLimiter(const Robot& robot, const LimitSet& limits, const FitOptions& fit,
                             const LiveLimits& bounds, double frame_time)
    : bounds_(bounds),
      frame_time_(frame_time),
      shortest_(kShortestStep * frame_time),
      before_(frame_time),
      position_{bounds.root_speed, bounds.resume_root_speed, bounds.root_acceleration},
      rotation_{bounds.turn_speed, bounds.resume_turn_speed, bounds.turn_acceleration},
      now_(static_cast<std::size_t>(robot.configuration_size()), 0.0),
      goal_(now_) {
  const auto& links = robot.tree().links();
  for (std::size_t link = 1; link < links.size(); ++link) {
    const auto joint = static_cast<std::size_t>(links[link].joint);
    const double own = robot.speed_limit(links[link].joint);
    JointRow row{};
    row.address = static_cast<std::size_t>(links[link].qpos_address);
    row.lower = limits.lower[joint];
    row.upper = limits.upper[joint];
    if (links[link].slides) {
      row.speed = own;
      row.first_speed = kFirstSlideShare * own;
      // Scale the acceleration so that reaching full speed takes as long as for a revolute joint.
      row.acceleration = bounds.joint_acceleration * own / fit.max_joint_speed;
    } else {
      row.speed = std::min({own, fit.max_joint_speed, fit.max_joint_step / frame_time});
      row.first_speed = bounds.resume_joint_speed;
      row.acceleration = bounds.joint_acceleration;
    }
    joints_.push_back(row);
  }
}

void MotionLimiter::reset() {
  begun_ = has_goal_ = false;
  before_ = frame_time_;
  since_.reset();
}

bool MotionLimiter::is_uneven(double seconds) const {
  return seconds != frame_time_ || before_ != frame_time_;
}

void MotionLimiter::set_off_slowly() {
  since_ = 0.0;
  has_goal_ = false;
}

double MotionLimiter::ramped(double first, double full) const {
  if (!since_) return full;
  return std::min(full, first + (full - first) * *since_ / bounds_.resume_s);
}

double MotionLimiter::ramped_acceleration(double full) const {
  return ramped(kFirstAcceleration * full, full);
}

// The longest step at a speed, in its own duration as well as in that of a frame.
double MotionLimiter::most_step(double speed, double seconds) const {
  return below_printed(speed * std::min(seconds, frame_time_));
}

void MotionLimiter::take(std::span<const double> wanted, double seconds) {
  const Eigen::Vector4d before = Eigen::Map<const Eigen::Vector4d>(now_.data() + 3);
  for (JointRow& joint : joints_) {
    const double next = std::clamp(wanted[joint.address], joint.lower, joint.upper);
    joint.velocity = begun_ ? (next - now_[joint.address]) / seconds : 0.0;
  }
  const Vector3d way =
      Eigen::Map<const Vector3d>(wanted.data()) - Eigen::Map<const Vector3d>(now_.data());
  position_.velocity = begun_ ? Vector3d(way / seconds) : Vector3d::Zero();
  rotation_.velocity =
      begun_ ? Vector3d(log_so3(root_rotation(now_).conjugate() * root_rotation(wanted)) / seconds)
             : Vector3d::Zero();
  std::ranges::copy(wanted, now_.begin());
  for (const JointRow& joint : joints_) {
    now_[joint.address] = std::clamp(now_[joint.address], joint.lower, joint.upper);
  }
  if (begun_) align_sign(before, Eigen::Map<Eigen::Vector4d>(now_.data() + 3));
  std::ranges::copy(wanted, goal_.begin());
  before_ = begun_ ? seconds : frame_time_;
  begun_ = has_goal_ = true;
}

bool MotionLimiter::follow(std::span<const double> wanted, double seconds) {
  if (!begun_) {
    take(wanted, seconds);
    since_.reset();
    return false;
  }
  const bool limited = step_towards(wanted, seconds);
  std::ranges::copy(wanted, goal_.begin());
  has_goal_ = true;
  if (since_) {
    *since_ += std::min(seconds, frame_time_);
    if (*since_ >= bounds_.resume_s) since_.reset();
  }
  return limited;
}

bool MotionLimiter::stop(double seconds) {
  // The next target is unrelated to the one before. The resume limits ramp up only while there is a
  // target.
  has_goal_ = false;
  // A target at the current configuration that does not move leaves only braking.
  return step_towards(now_, seconds);
}

// The target may be the current configuration itself.
bool MotionLimiter::step_towards(std::span<const double> wanted, double seconds) {
  bool limited = follow_position(wanted, seconds);
  limited = follow_rotation(wanted, seconds) || limited;
  for (JointRow& joint : joints_) {
    limited = follow_joint(joint, wanted[joint.address], seconds) || limited;
  }
  before_ = seconds;
  return limited;
}

bool MotionLimiter::follow_joint(JointRow& joint, double wanted, double seconds) {
  double& now = now_[joint.address];
  const double goal = std::clamp(wanted, joint.lower, joint.upper);
  const double velocity = joint.velocity, apart = between_middles(seconds);
  const double full = joint.acceleration * apart;
  // Aim at the moving target: its next position, reached with its velocity.
  const double aim =
      has_goal_ ? (goal - std::clamp(goal_[joint.address], joint.lower, joint.upper)) / seconds
                : 0.0;
  const double ahead = goal - now - aim * seconds;
  const double braked = std::sqrt(2.0 * joint.acceleration * std::abs(ahead));
  double next = aim + std::copysign(std::min(std::abs(ahead) / seconds, braked), ahead);
  if (is_uneven(seconds)) {
    const double last = velocity * before_;
    const double change = joint.acceleration * frame_time_ * frame_time_;
    next = std::clamp(next, (last - change) / seconds, (last + change) / seconds);
  }
  const double faster = ramped_acceleration(joint.acceleration) * apart;
  next = std::clamp(next, velocity > 0.0 ? std::max(velocity - full, -faster) : velocity - faster,
                    velocity < 0.0 ? std::min(velocity + full, faster) : velocity + faster);
  // A joint that exceeds the speed limit brakes.
  const double most = std::max(most_step(ramped(joint.first_speed, joint.speed), seconds) / seconds,
                               std::abs(velocity) - full);
  next = std::clamp(next, -most, most);
  next = std::clamp(next, -braking_speed(now - joint.lower, joint.acceleration, seconds, shortest_),
                    braking_speed(joint.upper - now, joint.acceleration, seconds, shortest_));
  next = std::clamp(next, velocity - full, velocity + full);
  next = std::clamp(next, -last_braking_speed(now - joint.lower, joint.acceleration, seconds),
                    last_braking_speed(joint.upper - now, joint.acceleration, seconds));
  const double before = now;
  constexpr double kReached = 1e-12;  // rad
  const double reached = before + next * seconds;
  const bool limited = std::abs(reached - goal) > kReached;
  now = limited ? std::clamp(reached, joint.lower, joint.upper) : goal;
  joint.velocity = (now - before) / seconds;
  return limited;
}

// @return the limited step; nothing if the target is reached
std::optional<Vector3d> MotionLimiter::limited_step(RootPart& part, const Vector3d& way,
                                                    const Vector3d& aim, double seconds) const {
  const double apart = between_middles(seconds), full = part.acceleration * apart;
  const Vector3d ahead = way - aim * seconds;
  Vector3d next = aim;
  if (const double length = ahead.norm(); length > 0.0) {
    next +=
        ahead * (std::min(length / seconds, std::sqrt(2.0 * part.acceleration * length)) / length);
  }
  const double before = part.velocity.norm();
  const double most = most_step(ramped(part.first_speed, part.speed), seconds) / seconds;
  if (before > most) {
    // Brake if the speed exceeds the limit.
    next = part.velocity * (std::max(most, before - full) / before);
  } else {
    if (is_uneven(seconds)) {
      const Vector3d last = part.velocity * (before_ / seconds);
      const double allowed = part.acceleration * frame_time_ * frame_time_ / seconds;
      next = last + shortened(next - last, allowed);
    }
    next = shortened(next, most);
    const Vector3d change = next - part.velocity;
    // Slowing down or turning uses the full acceleration; speeding up is limited by the ramp.
    const double faster = ramped_acceleration(part.acceleration) * apart;
    const double allowed = next.norm() > before ? faster : full;
    next = part.velocity + shortened(change, allowed);
  }
  constexpr double kReached = 1e-12;  // metres, rad
  const bool limited = (next * seconds - way).norm() > kReached;
  part.velocity = limited ? next : Vector3d(way / seconds);
  if (!limited) return std::nullopt;
  return Vector3d(next * seconds);
}

bool MotionLimiter::follow_position(std::span<const double> wanted, double seconds) {
  Eigen::Map<Vector3d> position(now_.data());
  const Eigen::Map<const Vector3d> goal(wanted.data());
  const Vector3d aim = has_goal_
                           ? Vector3d((goal - Eigen::Map<const Vector3d>(goal_.data())) / seconds)
                           : Vector3d::Zero();
  const auto step = limited_step(position_, goal - position, aim, seconds);
  if (step) {
    position += *step;
  } else {
    position = goal;
  }
  return step.has_value();
}

// Works in the root's own axes, which change little between two steps.
bool MotionLimiter::follow_rotation(std::span<const double> wanted, double seconds) {
  Eigen::Map<Eigen::Vector4d> rotation(now_.data() + 3);
  const Eigen::Vector4d before = rotation;
  const Quaterniond from = root_rotation(now_), to = root_rotation(wanted);
  const Vector3d aim = has_goal_
                           ? Vector3d(log_so3(root_rotation(goal_).conjugate() * to) / seconds)
                           : Vector3d::Zero();
  const auto step = limited_step(rotation_, log_so3(from.conjugate() * to), aim, seconds);
  if (step) {
    const Quaterniond next = (from * exp_so3(*step)).normalized();
    rotation << next.w(), next.x(), next.y(), next.z();
  } else {
    rotation = Eigen::Map<const Eigen::Vector4d>(wanted.data() + 3);
  }
  align_sign(before, rotation);
  return step.has_value();
}

}  // namespace retarget
