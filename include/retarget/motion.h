#pragma once

#include <memory>
#include <span>
#include <vector>

#include "retarget/clip.h"
#include "retarget/export.h"
#include "retarget/robot.h"

namespace RETARGET_API retarget {

/// A motion of a robot: one configuration per frame (layout: see Robot), root quaternions
/// sign-continuous.
class RobotClip {
 public:
  RobotClip() = default;
  /// All frames at the robot's zero configuration.
  RobotClip(std::shared_ptr<const Robot> robot, FrameRate rate, int frame_count);

  [[nodiscard]] const Robot& robot() const { return *robot_; }
  [[nodiscard]] const std::shared_ptr<const Robot>& shared_robot() const { return robot_; }
  [[nodiscard]] const FrameRate& rate() const { return rate_; }
  [[nodiscard]] int frame_count() const { return frame_count_; }

  [[nodiscard]] std::span<double> qpos(int frame);
  [[nodiscard]] std::span<const double> qpos(int frame) const;

 private:
  std::shared_ptr<const Robot> robot_;
  FrameRate rate_;
  int frame_count_ = 0;
  std::vector<double> qpos_;  // frame-major
};

}  // namespace retarget
