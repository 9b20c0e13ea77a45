#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/try.h"
#include "retarget/clip.h"
#include "retarget/motion.h"
#include "retarget/normalize_start.h"
#include "retarget/resample.h"
#include "retarget/robot.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"
#include "retarget/trigonometry.h"

namespace retarget {

RobotClip::RobotClip(std::shared_ptr<const Robot> robot, FrameRate rate, int frame_count)
    : robot_(std::move(robot)), rate_(rate), frame_count_(frame_count) {
  const std::vector<double> zero = robot_->zero_configuration();
  qpos_.reserve(zero.size() * frame_count);
  for (int frame = 0; frame < frame_count; ++frame) {
    qpos_.insert(qpos_.end(), zero.begin(), zero.end());
  }
}

std::span<double> RobotClip::qpos(int frame) {
  const std::size_t size = robot_->configuration_size();
  return {qpos_.data() + frame * size, size};
}

std::span<const double> RobotClip::qpos(int frame) const {
  const std::size_t size = robot_->configuration_size();
  return {qpos_.data() + frame * size, size};
}

namespace {

constexpr int kRootValues = 7;
// Excess over a limit that is ignored, rad or m: the digits of a CSV.
constexpr double kLimitRounding = 1e-6;

// Returns a chain that carries joint positions as translations, three per joint after the root,
// because resample() works on tracks of points.
std::shared_ptr<const Skeleton> carrier(int joint_values) {
  const std::vector<Channel> moved = {Channel::kXPosition, Channel::kYPosition,
                                      Channel::kZPosition};
  std::vector<Joint> joints;
  for (int i = 0; i <= (joint_values + 2) / 3; ++i) {
    Joint joint;
    joint.name = std::to_string(i);
    joint.parent = i - 1;
    joint.channels = moved;
    joints.push_back(std::move(joint));
  }
  return std::make_shared<const Skeleton>(std::move(joints));
}

// Splines and filters overshoot. Joints that are inside their limits in all frames of the source
// stay inside; others exceed them as before.
void keep_inside_limits(const RobotClip& source, const LimitSet& limits, RobotClip& clip) {
  const auto& joints = source.robot().joints();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto address = static_cast<std::size_t>(joints[j].qpos_address);
    double least = limits.lower[j], greatest = limits.upper[j];
    for (int frame = 0; frame < source.frame_count(); ++frame) {
      least = std::min(least, source.qpos(frame)[address]);
      greatest = std::max(greatest, source.qpos(frame)[address]);
    }
    if (least < limits.lower[j] - kLimitRounding || greatest > limits.upper[j] + kLimitRounding) {
      continue;
    }
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      double& value = clip.qpos(frame)[address];
      value = std::clamp(value, least, greatest);
    }
  }
}

}  // namespace

Result<RobotClip> resample_robot(const RobotClip& source, const FrameRate& output_rate,
                                 const ResampleOptions& options) {
  const int values = source.robot().configuration_size() - kRootValues;
  Clip carried(carrier(values), source.rate(), source.frame_count());
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    const auto qpos = source.qpos(frame);
    const auto points = carried.translations(frame);
    points[0] = {qpos[0], qpos[1], qpos[2]};
    carried.rotations(frame)[0] = root_rotation(qpos);
    for (int i = 0; i < values; ++i) points[1 + i / 3][i % 3] = qpos[kRootValues + i];
  }
  TRY_ASSIGN(const auto resampled, resample(std::move(carried), output_rate, options));
  RobotClip clip(source.shared_robot(), resampled.rate(), resampled.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    const auto points = resampled.translations(frame);
    for (int i = 0; i < 3; ++i) qpos[i] = points[0][i];
    set_root_rotation(qpos, resampled.rotations(frame)[0]);
    for (int i = 0; i < values; ++i) qpos[kRootValues + i] = points[1 + i / 3][i % 3];
  }
  TRY_ASSIGN(const LimitSet limits, load_limits(source.robot(), source.robot().limits_for({})));
  keep_inside_limits(source, limits, clip);
  return clip;
}

namespace {

// Below this horizontal length of the unit x axis, the axis is too steep to define a heading.
constexpr double kSteep = 0.1;

}  // namespace

double heading(const Eigen::Quaterniond& world_from_body) {
  const Eigen::Vector3d x = world_from_body * Eigen::Vector3d::UnitX();
  if (x.head<2>().norm() > kSteep) return portable::atan2(x.y(), x.x());
  return 2.0 * portable::atan2(world_from_body.z(), world_from_body.w());
}

StartNormalizer::StartNormalizer(std::span<const double> first)
    : origin_(first[0], first[1], 0.0),
      turn_(exp_so3(-heading(root_rotation(first)) * Eigen::Vector3d::UnitZ())) {}

StartNormalizer::StartNormalizer(const RobotClip& clip) {
  if (clip.frame_count() > 0) *this = StartNormalizer(clip.qpos(0));
}

void StartNormalizer::apply(std::span<double> qpos) const {
  const Pose root = root_pose(qpos);
  const Eigen::Vector3d position = turn_ * (root.translation - origin_);
  for (int i = 0; i < 3; ++i) qpos[i] = position[i];
  set_root_rotation(qpos, turn_ * root.rotation);
}

void StartNormalizer::apply(RobotClip& clip) const {
  for (int frame = 0; frame < clip.frame_count(); ++frame) apply(clip.qpos(frame));
}

void normalize_start(RobotClip& clip) {
  StartNormalizer(clip).apply(clip);
}

}  // namespace retarget
