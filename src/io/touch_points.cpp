#include "io/touch_points.h"

namespace retarget {

std::vector<TouchPoint> touch_points(const Robot& robot) {
  std::vector<TouchPoint> points;
  for (const Sole& sole : robot.profile().soles) {
    for (const Eigen::Vector3d& point : sole.points) points.push_back({sole.body, point});
  }
  if (!points.empty()) return points;
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    points.push_back({static_cast<int>(b), Eigen::Vector3d::Zero()});
  }
  return points;
}

}  // namespace retarget
