#pragma once

#include <span>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// A robot standing upright: its zero configuration clamped to the limits, soles on the floor.
/// With a fixed base the root stays where it is.
class StandingPose {
 public:
  StandingPose(const Robot& robot, const LimitSet& limits);

  /// Moves the pose to the horizontal position and heading of a configuration.
  void place(std::span<const double> qpos);
  [[nodiscard]] std::span<const double> qpos() const { return qpos_; }

 private:
  std::vector<double> qpos_;
  bool stands_fast_ = false;
};

}  // namespace retarget
