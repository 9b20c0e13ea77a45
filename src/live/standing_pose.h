#pragma once

#include <span>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// A robot that stands upright: its zero configuration inside the limits, soles on the floor.
class StandingPose {
 public:
  StandingPose(const Robot& robot, const LimitSet& limits);

  /// Where the robot is and where it faces.
  void place(std::span<const double> qpos);
  [[nodiscard]] std::span<const double> qpos() const { return qpos_; }

 private:
  std::vector<double> qpos_;
  bool stands_fast_ = false;
};

}  // namespace retarget
