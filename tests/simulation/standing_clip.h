#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <memory>

#include "retarget/kinematic_tree.h"
#include "retarget/motion.h"
#include "solve/dynamics/support_points.h"

namespace retarget {

/// A robot that holds its zero configuration, leaning forward, with its lowest point on the floor.
inline RobotClip standing_clip(const std::shared_ptr<const Robot>& robot, int frames,
                               double lean_rad = 0.0) {
  std::vector<double> qpos = robot->zero_configuration();
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(lean_rad, Eigen::Vector3d::UnitY()));
  qpos[3] = turn.w();
  for (int k = 0; k < 3; ++k) qpos[4 + k] = turn.vec()[k];
  const TreeState state(robot->tree(), qpos);
  double lowest = std::numeric_limits<double>::infinity();
  for (const SupportPoint& point : make_support_points(*robot)) {
    lowest = std::min(lowest, lowest_of(point, state).z());
  }
  qpos[2] -= lowest;
  RobotClip clip(robot, FrameRate{30, 1}, frames);
  for (int i = 0; i < frames; ++i) std::ranges::copy(qpos, clip.qpos(i).begin());
  return clip;
}

}  // namespace retarget
