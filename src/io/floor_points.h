#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "retarget/robot/robot.h"

namespace retarget {

/// A point of a robot that may touch the floor.
struct FloorPoint {
  int body;
  Eigen::Vector3d place;  ///< In the body's frame, metres.
};

/// The soles' points, else the origins of the bodies.
[[nodiscard]] std::vector<FloorPoint> floor_points(const Robot& robot);

}  // namespace retarget
