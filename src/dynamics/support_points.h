#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "retarget/robot.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// A point of a robot that the floor can push against: a sole's, or the end of another primitive.
struct SupportPoint {
  int link = 0;  ///< Of Robot::tree().
  Eigen::Vector3d in_link = Eigen::Vector3d::Zero();
  double radius = 0.0;  ///< The surface is so much below it, metres.
  bool of_sole = false;
};

/// The points of the soles, then the ends of capsules, spheres and the corners of boxes of all
/// bodies that have no sole.
[[nodiscard]] std::vector<SupportPoint> make_support_points(const Robot& robot);

/// Where the surface is lowest, in the world.
[[nodiscard]] Eigen::Vector3d lowest_of(const SupportPoint& point, const TreeState& state);

/// Of many points at most so many, those farthest out in as many horizontal directions: the rest
/// lies between them.
/// @param chosen  indices into points; on return the few, ascending.
void keep_outermost(std::span<const Eigen::Vector3d> points, std::size_t most,
                    std::vector<int>& chosen);

}  // namespace retarget
