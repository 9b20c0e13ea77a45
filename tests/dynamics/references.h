#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "retarget/reference.h"
#include "retarget/so3.h"
#include "robot/shipped_robots.h"
#include "support/value_of.h"

namespace retarget {

// The robot in its zero configuration with its soles on the floor.
inline RobotClip reference_stand(const std::shared_ptr<const Robot>& robot, int frames) {
  RobotClip clip(robot, {30, 1}, frames);
  std::vector<Pose> bodies(robot->bodies().size());
  forward_kinematics(*robot, clip.qpos(0), bodies);
  double lowest = 1e9;
  for (const Sole& sole : robot->profile().soles) {
    for (const Eigen::Vector3d& point : sole.points) {
      lowest = std::min(lowest, (bodies[static_cast<std::size_t>(sole.body)] * point).z());
    }
  }
  if (robot->profile().soles.empty()) lowest = 0.0;
  for (int t = 0; t < frames; ++t) clip.qpos(t)[2] -= lowest;
  return clip;
}

// The same with every joint, the root and its rotation in motion.
inline RobotClip reference_sway(const std::shared_ptr<const Robot>& robot, int frames) {
  RobotClip clip = reference_stand(robot, frames);
  for (int t = 0; t < frames; ++t) {
    const double time = t / 30.0;
    const auto q = clip.qpos(t);
    q[0] += 0.05 * std::sin(4.0 * time);
    q[1] += 0.03 * std::cos(5.0 * time);
    const Eigen::Quaterniond turn = exp_so3(Eigen::Vector3d(
        0.2 * std::sin(3.0 * time), 0.1 * time * time, 0.3 * std::sin(2.0 * time + 1.0)));
    q[3] = turn.w();
    for (int k = 0; k < 3; ++k) q[static_cast<std::size_t>(4 + k)] = turn.vec()[k];
    for (std::size_t j = 7; j < q.size(); ++j) {
      q[j] += 0.05 * std::sin(3.0 * time + static_cast<double>(j));
    }
  }
  return clip;
}

inline MotionReference reference_of(const RobotClip& clip, double rate) {
  ReferenceOptions options;
  options.rate = frame_rate_from_fps(rate);
  return value_of(make_reference(clip, options));
}

inline std::span<const double> row_of(const std::vector<double>& values, std::size_t rows,
                                      std::size_t row) {
  const std::size_t width = values.size() / rows;
  return std::span(values).subspan(row * width, width);
}

inline Eigen::Vector3d three_of(std::span<const double> values, std::size_t first = 0) {
  return {values[first], values[first + 1], values[first + 2]};
}

inline Eigen::Quaterniond rotation_of(std::span<const double> qpos) {
  return {qpos[3], qpos[4], qpos[5], qpos[6]};
}

}  // namespace retarget
