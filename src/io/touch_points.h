#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// A point of a robot that may touch the floor.
struct TouchPoint {
  int body;
  Eigen::Vector3d place;  ///< In the body's frame, metres.
};

/// The soles' points, else the origins of the bodies.
[[nodiscard]] std::vector<TouchPoint> touch_points(const Robot& robot);

}  // namespace retarget
