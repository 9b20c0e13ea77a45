#include "retarget/clip.h"
#include "retarget/motion.h"
#include "retarget/robot.h"

#include <memory>
#include <span>
#include <utility>
#include <vector>

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

}  // namespace retarget
